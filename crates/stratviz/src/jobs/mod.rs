//! Work off the UI thread. Nothing here knows of a window: a job is given a `wake` to call after
//! each message.

pub mod inside;
pub mod map;
pub mod picture;
pub mod scene;
pub mod study;
pub mod trade;
pub mod watch;

pub use inside::{InsideJob, PointsAsked, Seen};
pub use map::{MapJob, MapUpdate, Studied};
pub use picture::{Patch, PictureJob};
pub use scene::{Loaded, SceneJob};
pub use study::{StudyJob, Subject, study_job};
pub use trade::{TradeJob, trade_job};
pub use watch::WatchJob;

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc;

/// Wakes whoever polls a job; called from the worker.
pub type Wake = Arc<dyn Fn() + Send + Sync>;

/// How a job stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Standing {
    /// At work.
    Running,
    /// Ended by itself; everything it sent has been received.
    Done,
    /// It panicked. What it sent before stands.
    Died,
}

/// One computation off the UI thread. Dropping it cancels, which is how a new plan replaces an
/// old one.
pub struct Job<U> {
    cancel: Arc<AtomicBool>,
    messages: mpsc::Receiver<Message<U>>,
    standing: Standing,
}

enum Message<U> {
    Update(U),
    Done,
}

/// The worker's end of a job.
pub struct Reporter<U> {
    cancel: Arc<AtomicBool>,
    messages: Option<mpsc::Sender<Message<U>>>,
    wake: Wake,
}

impl<U> Reporter<U> {
    /// Set when nobody wants the result any more.
    pub fn cancel(&self) -> &AtomicBool {
        &self.cancel
    }

    /// Whether nobody wants the result any more.
    pub fn is_cancelled(&self) -> bool {
        self.cancel.load(Ordering::Relaxed)
    }

    /// Sends, then wakes: whoever wakes finds the message.
    pub fn send(&self, update: U) {
        self.deliver(Message::Update(update));
    }

    fn deliver(&self, message: Message<U>) {
        // Nobody listens any more when the job was dropped.
        if self.messages.as_ref().is_some_and(|messages| messages.send(message).is_ok()) {
            (self.wake)();
        }
    }
}

impl<U> Drop for Reporter<U> {
    /// Hangs up, then wakes once more, so that the end is seen even of a worker that panicked.
    fn drop(&mut self) {
        self.messages = None;
        (self.wake)();
    }
}

impl<U: Send + 'static> Job<U> {
    /// Starts `work` on a thread of this name.
    pub fn spawn(name: &str, wake: Wake, work: impl FnOnce(&Reporter<U>) + Send + 'static) -> Self {
        let (sender, messages) = mpsc::channel();
        let cancel = Arc::new(AtomicBool::new(false));
        let reporter = Reporter { cancel: cancel.clone(), messages: Some(sender), wake };
        let worker = std::thread::Builder::new().name(name.to_owned()).spawn(move || {
            work(&reporter);
            reporter.deliver(Message::Done);
        });
        // Without a thread the reporter is gone, and the job will be found dead.
        drop(worker);
        Self { cancel, messages, standing: Standing::Running }
    }

    /// What came in since the last call.
    pub fn poll(&mut self) -> Vec<U> {
        let mut updates = Vec::new();
        while self.standing == Standing::Running {
            match self.messages.try_recv() {
                Ok(Message::Update(update)) => updates.push(update),
                Ok(Message::Done) => self.standing = Standing::Done,
                Err(mpsc::TryRecvError::Empty) => break,
                Err(mpsc::TryRecvError::Disconnected) => self.standing = Standing::Died,
            }
        }
        updates
    }

    /// How it stood at the last [`poll`](Self::poll).
    pub fn standing(&self) -> Standing {
        self.standing
    }
}

impl<U> Drop for Job<U> {
    fn drop(&mut self) {
        self.cancel.store(true, Ordering::Relaxed);
    }
}

/// Lets work in the background step aside while someone waits for a click's answer.
#[derive(Clone, Default)]
pub struct RightOfWay(Arc<AtomicUsize>);

impl RightOfWay {
    /// Holds others back until the guard is dropped.
    pub fn take(&self) -> Urgent {
        self.0.fetch_add(1, Ordering::Relaxed);
        Urgent(self.clone())
    }

    /// Waits while anyone has the right of way, but not for a job that is cancelled.
    pub fn give<U>(&self, reporter: &Reporter<U>) {
        while self.0.load(Ordering::Relaxed) > 0 && !reporter.is_cancelled() {
            std::thread::sleep(std::time::Duration::from_millis(2));
        }
    }
}

/// Has the right of way as long as it lives.
pub struct Urgent(RightOfWay);

impl Drop for Urgent {
    fn drop(&mut self) {
        self.0.0.fetch_sub(1, Ordering::Relaxed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A wake that a test can wait for.
    fn bell() -> (Wake, mpsc::Receiver<()>) {
        let (sender, rung) = mpsc::channel();
        (Arc::new(move || sender.send(()).unwrap_or_default()), rung)
    }

    #[test]
    fn every_message_is_there_when_the_wake_comes() {
        let (wake, rung) = bell();
        let mut job = Job::spawn("count", wake, |reporter| {
            for i in 0..3 {
                reporter.send(i);
            }
        });
        let mut seen = Vec::new();
        while job.standing() == Standing::Running {
            rung.recv().unwrap();
            seen.extend(job.poll());
        }
        assert_eq!((seen, job.standing()), (vec![0, 1, 2], Standing::Done));
    }

    #[test]
    fn a_panic_is_seen_and_what_was_sent_before_stands() {
        let (wake, rung) = bell();
        let mut job = Job::spawn("trip", wake, |reporter| {
            reporter.send(1);
            std::panic::resume_unwind(Box::new("tripped"));
        });
        let mut seen = Vec::new();
        while job.standing() == Standing::Running {
            rung.recv().unwrap();
            seen.extend(job.poll());
        }
        assert_eq!((seen, job.standing()), (vec![1], Standing::Died));
    }

    #[test]
    fn dropping_a_job_cancels_it() {
        let (wake, rung) = bell();
        let (ended, end) = mpsc::channel();
        let job = Job::<()>::spawn("endless", wake, move |reporter| {
            while !reporter.is_cancelled() {
                std::thread::yield_now();
            }
            ended.send(()).unwrap();
        });
        drop(job);
        end.recv().unwrap();
        drop(rung);
    }

    #[test]
    fn the_background_waits_for_the_urgent() {
        let way = RightOfWay::default();
        let urgent = way.take();
        let (wake, _rung) = bell();
        let (passed, gate) = mpsc::channel();
        let background = way.clone();
        let _job = Job::<()>::spawn("background", wake, move |reporter| {
            background.give(reporter);
            passed.send(()).unwrap();
        });
        assert!(gate.recv_timeout(std::time::Duration::from_millis(20)).is_err());
        drop(urgent);
        gate.recv().unwrap();
    }
}
