//! `cg run --serve`: the live page, for a browser in the cab or a phone next to the truck.
//!
//! | file | what |
//! |---|---|
//! | `address` | where it listens |
//! | `request` | what may be asked for |
//! | `turn` | roll over lateral acceleration of the last maneuver |
//! | `queue` | from the estimation to the server |
//! | `board` | what the server knows, in limited room |
//! | `client` | one client, slow or not |
//! | `server` | the thread |
//!
//! The estimation never waits for the server: it puts events and values into a queue and goes on. If the queue is
//! full, they are dropped. The events on standard output are not affected.

pub(crate) mod address;
mod board;
mod client;
mod queue;
mod request;
mod server;
mod turn;

use std::net::SocketAddr;
use std::thread::{Builder, JoinHandle};
use std::time::{Duration, Instant};

use anyhow::Context as _;
use cg_core::{Design, Maneuver, Sample};
use cg_logs::web;

use super::events::{Result as Known, Status};
use address::Address;
use board::Message;
use queue::{Inlet, queue};
use server::Server;
use turn::Recent;

pub(crate) use board::Kind;

/// Time between two snapshots of the present values, in stream time, µs.
const SNAPSHOT_US: u64 = 100_000;
/// Least time between two snapshots. A replay is faster than its stream time.
const LEAST: Duration = Duration::from_millis(50);

const PAGE: &str = include_str!("page.html");
const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = include_str!("page.js");

/// The estimation's side of the page.
pub(crate) struct Page {
    /// The page's address for a browser on this computer.
    pub(crate) url: String,
    /// Whether other computers can open it.
    pub(crate) is_open: bool,
    inlet: Option<Inlet>,
    thread: Option<JoinHandle<()>>,
    recent: Recent,
    next_us: u64,
    shown: Option<Instant>,
}

impl Page {
    /// Opens the address and starts the server.
    pub(crate) fn open(address: &Address) -> anyhow::Result<Self> {
        let listener = address.listen()?;
        let open = listener.set_nonblocking(true).and_then(|()| listener.local_addr());
        let local = open.context("--serve: the address cannot be used")?;
        let (inlet, outlet) = queue();
        let name = address.name().map(str::to_owned);
        let server = Server { listener, outlet, page: page(), name };
        let thread = Builder::new().name("page".to_owned()).spawn(|| server.run());
        Ok(Self {
            url: url(local),
            is_open: !local.ip().is_loopback(),
            inlet: Some(inlet),
            thread: Some(thread.context("--serve: no thread for the server")?),
            recent: Recent::default(),
            next_us: 0,
            shown: None,
        })
    }

    /// Puts a message into the queue, or drops it.
    fn tell(&self, message: Message) {
        if let Some(inlet) = &self.inlet {
            inlet.put(message);
        }
    }

    /// Shows a line of the output.
    pub(crate) fn line(&self, kind: Kind, line: &str) {
        self.tell(Message::Line(kind, line.to_owned()));
    }

    /// Whether the present values should be shown at this stream time.
    pub(crate) fn is_due(&mut self, now_us: u64) -> bool {
        let now = || Instant::now();
        if now_us < self.next_us || self.shown.is_some_and(|shown| now() - shown < LEAST) {
            return false;
        }
        (self.next_us, self.shown) = (now_us + SNAPSHOT_US, Some(now()));
        true
    }

    /// Shows the present values.
    pub(crate) fn snapshot(&self, time_s: f64, status: Status) {
        self.tell(Message::Snapshot(time_s, Box::new(status)));
    }

    /// Remembers the signals of a sample for the next maneuver.
    pub(crate) fn remember(&mut self, sample: &Sample<f64>, speed_mps: f64, gravity_mps2: f64) {
        self.recent.push(sample, speed_mps, gravity_mps2);
    }

    /// Shows a maneuver. The times are those of the event and of the estimator's time zero, s.
    pub(crate) fn turn(
        &self,
        design: &Design<f64>,
        maneuver: &Maneuver<f64>,
        known: &Known,
        [time_s, origin_s]: [f64; 2],
    ) {
        if let Some(turn) = self.recent.turn(design, maneuver, known, origin_s) {
            self.tell(Message::Turn(time_s, Box::new(turn)));
        }
    }
}

impl Drop for Page {
    /// Sends the last events to the clients. This takes a second at most.
    fn drop(&mut self) {
        self.inlet = None;
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

fn page() -> String {
    web::fill(
        PAGE,
        &[
            ("{{base}}", web::STYLE),
            ("{{style}}", STYLE),
            ("{{chart}}", web::SCRIPT),
            ("{{script}}", SCRIPT),
        ],
    )
}

/// The address for a browser on this computer.
fn url(local: SocketAddr) -> String {
    let port = local.port();
    match local {
        _ if local.ip().is_unspecified() => format!("http://localhost:{port}/"),
        local => format!("http://{local}/"),
    }
}
