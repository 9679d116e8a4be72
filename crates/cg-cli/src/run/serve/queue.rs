//! The queue from the estimation to the server. Putting something into it never waits.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, TryRecvError, sync_channel};

use super::board::{Kind, Message};

/// Number of messages that wait for the server.
const ROOM: usize = 4096;
/// Periodic values are put into the queue only as long as there are fewer messages in it. A replay as fast as possible
/// may write more of them than the server takes, and they must not displace the other events.
const ROOM_FOR_VALUES: usize = ROOM / 2;

/// The side of the estimation.
#[derive(Debug)]
pub(super) struct Inlet {
    sender: SyncSender<Message>,
    waiting: Arc<AtomicUsize>,
}

/// The side of the server.
#[derive(Debug)]
pub(super) struct Outlet {
    receiver: Receiver<Message>,
    waiting: Arc<AtomicUsize>,
}

/// A queue.
pub(super) fn queue() -> (Inlet, Outlet) {
    let (sender, receiver) = sync_channel(ROOM);
    let waiting = Arc::new(AtomicUsize::new(0));
    (Inlet { sender, waiting: Arc::clone(&waiting) }, Outlet { receiver, waiting })
}

impl Inlet {
    /// Puts a message into the queue, or drops it if there is no room.
    pub(super) fn put(&self, message: Message) {
        let is_value = matches!(message, Message::Snapshot(..) | Message::Line(Kind::Status, _));
        if is_value && self.waiting.load(Ordering::Relaxed) >= ROOM_FOR_VALUES {
            return;
        }
        // The number is raised first, so that it never falls below zero.
        self.waiting.fetch_add(1, Ordering::Relaxed);
        if self.sender.try_send(message).is_err() {
            self.waiting.fetch_sub(1, Ordering::Relaxed);
        }
    }
}

impl Outlet {
    /// The next message: [`TryRecvError::Empty`] if there is none, and [`TryRecvError::Disconnected`] if none will follow.
    pub(super) fn take(&self) -> Result<Message, TryRecvError> {
        let message = self.receiver.try_recv()?;
        self.waiting.fetch_sub(1, Ordering::Relaxed);
        Ok(message)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(kind: Kind) -> Message {
        Message::Line(kind, String::new())
    }

    fn count(outlet: &Outlet, wanted: Kind) -> usize {
        std::iter::from_fn(|| outlet.take().ok())
            .filter(|message| matches!(message, Message::Line(kind, _) if *kind == wanted))
            .count()
    }

    /// The server stands still while a replay writes 100 000 values.
    #[test]
    fn values_do_not_displace_events_and_nothing_waits() {
        let (inlet, outlet) = queue();
        for round in 0..2 {
            for k in 0..100_000 {
                inlet.put(line(Kind::Status));
                if k % 1000 == 999 {
                    inlet.put(line(Kind::Maneuver));
                }
            }
            assert_eq!(count(&outlet, Kind::Maneuver), 100, "{round}");
        }
        // More events than there is room for are dropped.
        (0..2 * ROOM).for_each(|_| inlet.put(line(Kind::Notice)));
        assert_eq!(count(&outlet, Kind::Notice), ROOM);
        inlet.put(line(Kind::Status));
        drop(inlet);
        assert_eq!(count(&outlet, Kind::Status), 1);
        assert!(matches!(outlet.take(), Err(TryRecvError::Disconnected)));
    }
}
