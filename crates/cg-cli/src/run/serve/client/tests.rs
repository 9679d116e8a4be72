//! Clients that read slowly, not at all, or ask for nothing.

use super::super::board::{Kind, Message};
use super::*;

/// A connection with limited room for what the client has not read.
#[derive(Default)]
struct Fake {
    asked: Vec<u8>,
    got: Vec<u8>,
    room: usize,
    finished: bool,
    gone: bool,
}

impl Read for Fake {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.asked.is_empty() {
            return if self.gone { Ok(0) } else { Err(io::ErrorKind::WouldBlock.into()) };
        }
        let length = self.asked.len().min(buffer.len());
        buffer[..length].copy_from_slice(&self.asked[..length]);
        self.asked.drain(..length);
        Ok(length)
    }
}

impl Write for Fake {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let length = self.room.min(bytes.len());
        if length == 0 {
            return Err(io::ErrorKind::WouldBlock.into());
        }
        self.room -= length;
        self.got.extend(&bytes[..length]);
        Ok(length)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Connection for Fake {
    fn finish(&mut self) {
        self.finished = true;
    }
}

const OFFER: Offer<'static> = Offer { page: "<!doctype html>\n", name: None, has_room: true };
const ANY: usize = usize::MAX / 2;

/// A client that asks for this and can take so many bytes.
fn client(path: &str, room: usize) -> (Client<Fake>, Instant) {
    let asked = format!("GET {path} HTTP/1.1\r\nHost: localhost\r\n\r\n").into_bytes();
    let now = Instant::now();
    (Client::new(Fake { asked, room, ..Fake::default() }, now), now)
}

fn notice(board: &mut Board, number: usize) {
    board.take(Message::Line(Kind::Notice, format!("{{\"number\":{number}}}\n")));
}

/// The data of the events that the client has got.
fn data(client: &Client<Fake>) -> Vec<String> {
    let text = String::from_utf8(client.stream.got.clone()).unwrap();
    let lines = text.lines().filter_map(|line| line.strip_prefix("data: "));
    lines.map(str::to_owned).collect()
}

/// Whatever the client can take at a time, it gets the same bytes.
#[test]
fn a_slow_client_gets_the_same_bytes() {
    let mut board = Board::default();
    notice(&mut board, 0);
    let expected = {
        let (mut whole, now) = client("/events", ANY);
        assert!(whole.turn(&board, &OFFER, now));
        whole.stream.got
    };
    for step in [1, 7, 100] {
        let (mut slow, now) = client("/events", 0);
        while slow.stream.got.len() < expected.len() {
            slow.stream.room = step;
            assert!(slow.turn(&board, &OFFER, now));
        }
        assert_eq!(slow.stream.got, expected);
    }
}

/// What a client cannot take is not collected for it: it gets the newest values, and if it has missed events, all of
/// them again from the history.
#[test]
fn a_client_that_does_not_read_collects_nothing() {
    let mut board = Board::default();
    let (mut client, now) = client("/events", ANY);
    assert!(client.turn(&board, &OFFER, now));
    assert_eq!(data(&client), ["[]"]);
    client.stream.room = 0;
    for number in 0..10_000 {
        notice(&mut board, number);
        board.snapshot.set("snapshot", Ok(format!("{{\"snapshot\":{number}}}\n")));
        assert!(client.turn(&board, &OFFER, now));
        assert!(client.pending.len() < 200, "one event and one snapshot wait");
    }
    client.stream.room = ANY;
    assert!(client.turn(&board, &OFFER, now) && client.turn(&board, &OFFER, now));
    let data = data(&client);
    // The event and the snapshot that waited, then what has happened since.
    assert_eq!(&data[1..3], ["{\"number\":0}", "{\"snapshot\":0}"]);
    assert!(data[3].starts_with("[{\"number\":9968},") && data[3].ends_with(",{\"number\":9999}]"));
    assert_eq!(data[4..], ["{\"snapshot\":9999}"]);
}

#[test]
fn who_takes_nothing_is_dropped() {
    let mut board = Board::default();
    let (mut client, now) = client("/events", ANY);
    assert!(client.turn(&board, &OFFER, now));
    client.stream.room = 0;
    notice(&mut board, 0);
    assert!(client.turn(&board, &OFFER, now));
    assert!(client.turn(&board, &OFFER, now + STALLED));
    assert!(!client.turn(&board, &OFFER, now + STALLED + Duration::from_millis(1)));
}

/// Without events there is a sign of life, and the client stays.
#[test]
fn silence_is_not_the_end() {
    let board = Board::default();
    let (mut client, start) = client("/events", ANY);
    for second in 0..100 {
        assert!(client.turn(&board, &OFFER, start + Duration::from_secs(second)));
    }
    let signs = data(&client).iter().filter(|data| *data == "{}").count();
    assert!((30..=50).contains(&signs), "{signs}");
}

#[test]
fn who_asks_for_nothing_is_dropped() {
    let board = Board::default();
    let now = Instant::now();
    for asked in ["", "GET / HTTP/1.1\r\n"] {
        let asked = asked.as_bytes().to_vec();
        let mut client = Client::new(Fake { asked, room: ANY, ..Fake::default() }, now);
        assert!(client.turn(&board, &OFFER, now + ASKING));
        assert!(!client.turn(&board, &OFFER, now + ASKING + Duration::from_millis(1)));
        assert!(client.stream.got.is_empty());
    }
}

#[test]
fn the_page_ends_its_connection_and_a_closed_one_goes() {
    let board = Board::default();
    let (mut client, now) = client("/", ANY);
    assert!(client.turn(&board, &OFFER, now));
    let text = String::from_utf8(client.stream.got.clone()).unwrap();
    let (head, body) = text.split_once("\r\n\r\n").unwrap();
    assert!(head.starts_with("HTTP/1.1 200 OK\r\n") && body == OFFER.page, "{text}");
    assert!(head.contains(&format!("Content-Length: {}", OFFER.page.len())));
    assert!(client.stream.finished);
    assert!(client.turn(&board, &OFFER, now + CLOSING), "the browser has time to close");
    client.stream.gone = true;
    assert!(!client.turn(&board, &OFFER, now + CLOSING));
}

#[test]
fn there_is_a_limit_to_those_who_listen() {
    let board = Board::default();
    let (mut client, now) = client("/events", ANY);
    assert!(client.turn(&board, &Offer { has_room: false, ..OFFER }, now));
    assert!(!client.is_listening());
    assert!(client.stream.got.starts_with(b"HTTP/1.1 503 "));
}

/// After the request nothing is expected, and what comes is not collected.
#[test]
fn a_client_that_goes_on_talking_is_not_heard() {
    let mut board = Board::default();
    let (mut client, now) = client("/events", ANY);
    for number in 0..100 {
        client.stream.asked = b"GET /events HTTP/1.1\r\nHost: localhost\r\n\r\n".repeat(1000);
        notice(&mut board, number);
        assert!(client.turn(&board, &OFFER, now));
    }
    assert_eq!(String::from_utf8_lossy(&client.stream.got).matches("HTTP/1.1 200").count(), 1);
    assert_eq!(data(&client).len(), 100);
}
