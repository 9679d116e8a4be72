//! What the server knows: the events that a new client needs, the last ones for the others, and the present values.

use std::collections::VecDeque;
use std::io;
use std::sync::Arc;

use super::super::events::{self, Event, Status};
use super::turn::Turn;

/// Number of events that wait for slow clients. A client that is further behind gets everything again.
const WAITING: usize = 256;

/// How events are kept for clients that connect later.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Start,
    State,
    Status,
    Warning,
    SpeedRequest,
    Learned,
    Maneuver,
    LoadChanged,
    Notice,
    Stop,
}

impl From<&Event<'_>> for Kind {
    fn from(event: &Event<'_>) -> Self {
        match event {
            Event::Start { .. } => Self::Start,
            Event::State { .. } => Self::State,
            Event::Status(_) => Self::Status,
            Event::Warning { .. } => Self::Warning,
            Event::SpeedRequest { .. } => Self::SpeedRequest,
            Event::Learned { .. } => Self::Learned,
            Event::Maneuver(_) => Self::Maneuver,
            Event::LoadChanged { .. } => Self::LoadChanged,
            Event::Notice { .. } => Self::Notice,
            Event::Stop { .. } => Self::Stop,
        }
    }
}

impl Kind {
    /// How many of this kind are kept.
    const fn room(self) -> usize {
        match self {
            Self::Start | Self::State | Self::Status | Self::Learned | Self::Stop => 1,
            Self::Warning | Self::SpeedRequest | Self::LoadChanged | Self::Notice => 32,
            // A hundred kilobytes.
            Self::Maneuver => 128,
        }
    }
}

/// What the estimation tells the server.
#[derive(Debug)]
pub(super) enum Message {
    /// A line of the output.
    Line(Kind, String),
    /// The present values at a time stamp, s.
    Snapshot(f64, Box<Status>),
    /// The last maneuver at a time stamp, s.
    Turn(f64, Box<Turn>),
}

/// A value of which only the newest is needed. It has a number, so that a client gets it once.
#[derive(Debug, Default)]
pub(super) struct Newest {
    number: u64,
    frame: Vec<u8>,
}

impl Newest {
    pub(super) fn set(&mut self, name: &str, line: io::Result<String>) {
        if let Ok(line) = line {
            (self.number, self.frame) = (self.number + 1, frame(name, &line));
        }
    }

    /// The value, if it is newer than the one with this number.
    pub(super) fn after(&self, seen: &mut u64) -> Option<&[u8]> {
        (*seen < self.number).then(|| {
            *seen = self.number;
            self.frame.as_slice()
        })
    }
}

/// What the server knows. Its size is limited.
#[derive(Debug, Default)]
pub(super) struct Board {
    kept: Vec<(Kind, Arc<str>)>,
    lines: VecDeque<Arc<str>>,
    /// Number of lines so far.
    count: u64,
    pub(super) snapshot: Newest,
    pub(super) turn: Newest,
}

impl Board {
    pub(super) fn take(&mut self, message: Message) {
        match message {
            Message::Line(kind, line) => self.line(kind, line.trim_end().into()),
            Message::Snapshot(time_s, status) => {
                self.snapshot.set("snapshot", events::line(time_s, &Event::Status(status)));
            }
            Message::Turn(time_s, turn) => self.turn.set("turn", turn.line(time_s)),
        }
    }

    fn line(&mut self, kind: Kind, line: Arc<str>) {
        self.keep(kind, Arc::clone(&line));
        self.lines.push_back(line);
        self.count += 1;
        if self.lines.len() > WAITING {
            self.lines.pop_front();
        }
    }

    /// Keeps an event for later clients. Of too many maneuvers every second one is dropped, so that they still
    /// span the whole drive; of other events the oldest.
    fn keep(&mut self, kind: Kind, line: Arc<str>) {
        self.kept.push((kind, line));
        let count = self.kept.iter().filter(|(other, _)| *other == kind).count();
        if count <= kind.room() {
            return;
        }
        let mut place = 0;
        self.kept.retain(|(other, _)| {
            place += usize::from(*other == kind);
            *other != kind || if kind == Kind::Maneuver { place % 2 == 1 } else { place > 1 }
        });
    }

    /// What a new client needs, as one event.
    pub(super) fn history(&self) -> Vec<u8> {
        let lines: Vec<&str> = self.kept.iter().map(|(_, line)| &**line).collect();
        frame("history", &format!("[{}]", lines.join(",")))
    }

    /// The lines after the one with this number. `None` if some of them are no longer there.
    pub(super) fn since(&self, seen: u64) -> Option<impl Iterator<Item = Vec<u8>> + '_> {
        let wanted = usize::try_from(self.count - seen).ok()?;
        let first = self.lines.len().checked_sub(wanted)?;
        Some(self.lines.range(first..).map(|line| frame("message", line)))
    }

    /// The number of lines so far.
    pub(super) const fn count(&self) -> u64 {
        self.count
    }
}

/// A server-sent event. JSON on one line contains no line break.
pub(super) fn frame(name: &str, data: &str) -> Vec<u8> {
    let data = data.trim_end();
    match name {
        "message" => format!("data: {data}\n\n"),
        _ => format!("event: {name}\ndata: {data}\n\n"),
    }
    .into_bytes()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::Value;

    fn put(board: &mut Board, kind: Kind, number: usize) {
        board.take(Message::Line(kind, format!("{{\"kind\":\"{kind:?}\",\"number\":{number}}}\n")));
    }

    fn numbers(board: &Board, kind: Kind) -> Vec<u64> {
        let text = String::from_utf8(board.history()).unwrap();
        let data =
            text.strip_prefix("event: history\ndata: ").unwrap().strip_suffix("\n\n").unwrap();
        let lines: Vec<Value> = serde_json::from_str(data).unwrap();
        let of_kind = lines.iter().filter(|line| line["kind"] == format!("{kind:?}"));
        of_kind.map(|line| line["number"].as_u64().unwrap()).collect()
    }

    #[test]
    fn the_history_keeps_what_counts_in_limited_room() {
        let mut board = Board::default();
        put(&mut board, Kind::Start, 0);
        for number in 0..100_000 {
            put(&mut board, Kind::Status, number);
            put(&mut board, Kind::Maneuver, number);
            put(&mut board, Kind::Notice, number);
        }
        assert_eq!(numbers(&board, Kind::Start), [0]);
        assert_eq!(numbers(&board, Kind::Status), [99_999]);
        assert_eq!(numbers(&board, Kind::Notice), (99_968..100_000).collect::<Vec<_>>());
        // The first one stays, the last one is there, and none is out of order.
        let maneuvers = numbers(&board, Kind::Maneuver);
        assert!((64..=128).contains(&maneuvers.len()), "{}", maneuvers.len());
        assert_eq!((maneuvers[0], *maneuvers.last().unwrap()), (0, 99_999));
        assert!(maneuvers.is_sorted());
        assert!(board.lines.len() <= WAITING && board.history().len() < 20_000);
    }

    #[test]
    fn a_client_gets_each_line_once_or_everything_again() {
        let mut board = Board::default();
        for number in 0..WAITING {
            put(&mut board, Kind::Notice, number);
        }
        let all: Vec<Vec<u8>> = board.since(0).unwrap().collect();
        assert_eq!(all.len(), WAITING);
        assert_eq!(all[7], b"data: {\"kind\":\"Notice\",\"number\":7}\n\n");
        assert_eq!(board.since(board.count()).unwrap().count(), 0);
        put(&mut board, Kind::Notice, WAITING);
        assert!(board.since(0).is_none(), "the first line is gone");
        assert_eq!(board.since(1).unwrap().count(), WAITING);
    }

    #[test]
    fn of_the_present_values_only_the_newest_is_sent_and_once() {
        let mut newest = Newest::default();
        let mut seen = 0;
        assert_eq!(newest.after(&mut seen), None);
        for number in 0..3 {
            newest.set("snapshot", Ok(format!("{number}\n")));
        }
        assert_eq!(newest.after(&mut seen).unwrap(), b"event: snapshot\ndata: 2\n\n");
        assert_eq!(newest.after(&mut seen), None);
    }
}
