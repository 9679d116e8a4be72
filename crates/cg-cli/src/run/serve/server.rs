//! The thread of the server: it takes what the estimation tells, and serves all clients in turn.
//!
//! No connection blocks, so one thread is enough, and its work per turn is limited by the number of clients.

use std::net::{TcpListener, TcpStream};
use std::sync::mpsc::TryRecvError;
use std::thread;
use std::time::{Duration, Instant};

use socket2::SockRef;

use super::board::Board;
use super::client::{Client, Offer};
use super::queue::Outlet;

/// Time between two turns with clients, and without.
const TURN: Duration = Duration::from_millis(50);
const IDLE: Duration = Duration::from_millis(200);
/// Greatest number of clients that read the events.
const LISTENERS: usize = 24;
/// Greatest number of connections. Those that are no listeners end by themselves, so there is room again soon.
const CONNECTIONS: usize = 64;
/// What the system may keep for a slow client, in bytes. It is some seconds of events.
const BUFFER: usize = 64 << 10;
/// Time for the last events at the end of the program.
const ENDING: Duration = Duration::from_millis(500);

/// The server.
pub(super) struct Server {
    pub(super) listener: TcpListener,
    pub(super) outlet: Outlet,
    pub(super) page: String,
    /// The name of this computer, if it was given.
    pub(super) name: Option<String>,
}

impl Server {
    /// Serves until the estimation has ended.
    pub(super) fn run(self) {
        let mut board = Board::default();
        let mut clients: Vec<Client<TcpStream>> = Vec::new();
        let mut ended: Option<Instant> = None;
        loop {
            ended = ended.or(self.take(&mut board));
            self.accept(&mut clients);
            self.serve(&board, &mut clients);
            let served = clients.iter().all(Client::is_served);
            if ended.is_some_and(|since| served || since.elapsed() > ENDING) {
                return;
            }
            thread::sleep(if clients.is_empty() { IDLE } else { TURN });
        }
    }

    /// Takes what was told. Returns the time if nothing more will follow.
    fn take(&self, board: &mut Board) -> Option<Instant> {
        loop {
            match self.outlet.take() {
                Ok(message) => board.take(message),
                Err(TryRecvError::Empty) => return None,
                Err(TryRecvError::Disconnected) => return Some(Instant::now()),
            }
        }
    }

    fn accept(&self, clients: &mut Vec<Client<TcpStream>>) {
        while clients.len() < CONNECTIONS {
            let Ok((stream, _)) = self.listener.accept() else { return };
            if stream.set_nonblocking(true).is_ok() {
                // Without these the client is served too, only with more memory or later.
                let _ = SockRef::from(&stream).set_send_buffer_size(BUFFER);
                let _ = stream.set_nodelay(true);
                clients.push(Client::new(stream, Instant::now()));
            }
        }
    }

    fn serve(&self, board: &Board, clients: &mut Vec<Client<TcpStream>>) {
        let mut listeners = clients.iter().filter(|client| client.is_listening()).count();
        clients.retain_mut(|client| {
            let offer = Offer {
                page: &self.page,
                name: self.name.as_deref(),
                has_room: listeners < LISTENERS,
            };
            let listened = client.is_listening();
            let remains = client.turn(board, &offer, Instant::now());
            listeners += usize::from(!listened && client.is_listening());
            remains
        });
    }
}
