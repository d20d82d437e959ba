//! Work off the UI thread. Nothing here knows of a window: a job is given a `wake` to call after
//! each message.

pub mod inside;
pub mod map;
pub mod patterns;
pub mod picture;
pub mod scene;
pub mod study;
pub mod trade;
pub mod watch;

pub use inside::{InsideJob, PointsAsked, Seen};
pub use map::{MapJob, MapUpdate, Studied};
pub use patterns::{DiscrepancyPlan, Drawn, PatternJob, SpectrumSoFar};
pub use picture::{Patch, PictureJob};
pub use scene::{Loaded, SceneJob};
pub use study::{StudyJob, StudySoFar, Subject, study_job};
pub use trade::{TradeJob, Traded, trade_job};
pub use watch::WatchJob;

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::sync::mpsc;
use std::time::Duration;

/// Between two parts of a picture in the making: more of them would cost frames that nobody sees.
const PACE: Duration = Duration::from_millis(50);

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
    permille: Arc<AtomicU64>,
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
    permille: Arc<AtomicU64>,
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

    /// Says that `done` of `total` is done; wakes where that can be seen.
    pub fn progress(&self, done: u64, total: u64) {
        const SEEN: u64 = 10;
        let share = done as f64 / total.max(1) as f64;
        let permille = (1000.0 * share.min(1.0)) as u64;
        let before = self.permille.fetch_max(permille, Ordering::Relaxed);
        if permille / SEEN > before / SEEN {
            (self.wake)();
        }
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
        let permille = Arc::new(AtomicU64::new(0));
        let reporter = Reporter {
            cancel: cancel.clone(),
            permille: permille.clone(),
            messages: Some(sender),
            wake,
        };
        let worker = std::thread::Builder::new().name(name.to_owned()).spawn(move || {
            work(&reporter);
            reporter.deliver(Message::Done);
        });
        // Without a thread the reporter is gone, and the job will be found dead.
        drop(worker);
        Self { cancel, permille, messages, standing: Standing::Running }
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

    /// The share of the work that is done, 0 to 1, as far as the worker tells.
    pub fn share(&self) -> f32 {
        self.permille.load(Ordering::Relaxed) as f32 / 1000.0
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

/// Lets other work step aside while someone waits for a click's answer: all of it until the
/// first curve is there, the picture and the map until the last one is.
#[derive(Clone, Default)]
pub struct RightOfWay(Arc<Waiting>);

#[derive(Default)]
struct Waiting {
    /// For a first answer.
    first: AtomicUsize,
    /// For a whole one.
    whole: AtomicUsize,
}

impl RightOfWay {
    /// Holds others back until the guard is dropped.
    pub fn take(&self) -> Urgent {
        self.0.first.fetch_add(1, Ordering::Relaxed);
        self.0.whole.fetch_add(1, Ordering::Relaxed);
        Urgent { way: self.clone(), is_first: true }
    }

    /// Work in the background waits here while anyone has the right of way, but not when it is
    /// cancelled.
    pub fn give<U>(&self, reporter: &Reporter<U>) {
        wait(&self.0.whole, reporter);
    }

    /// Work that was asked for waits here for first answers alone.
    pub fn give_first<U>(&self, reporter: &Reporter<U>) {
        wait(&self.0.first, reporter);
    }
}

fn wait<U>(others: &AtomicUsize, reporter: &Reporter<U>) {
    while others.load(Ordering::Relaxed) > 0 && !reporter.is_cancelled() {
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// Has the right of way as long as it lives.
pub struct Urgent {
    way: RightOfWay,
    is_first: bool,
}

impl Urgent {
    /// The first answer is given.
    pub fn answered(&mut self) {
        if std::mem::take(&mut self.is_first) {
            self.way.0.first.fetch_sub(1, Ordering::Relaxed);
        }
    }
}

impl Drop for Urgent {
    fn drop(&mut self) {
        self.answered();
        self.way.0.whole.fetch_sub(1, Ordering::Relaxed);
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
    fn others_wait_for_the_urgent() {
        let way = RightOfWay::default();
        let mut urgent = way.take();
        let (wake, _rung) = bell();
        let (passed, gate) = mpsc::channel();
        let jobs = [("first", true), ("whole", false)].map(|(name, first)| {
            let (way, passed) = (way.clone(), passed.clone());
            Job::<()>::spawn(name, wake.clone(), move |reporter| {
                if first {
                    way.give_first(reporter)
                } else {
                    way.give(reporter)
                }
                passed.send(name).unwrap();
            })
        });
        let moment = Duration::from_millis(20);
        assert!(gate.recv_timeout(moment).is_err());
        urgent.answered();
        assert_eq!(gate.recv(), Ok("first"));
        assert!(gate.recv_timeout(moment).is_err());
        drop(urgent);
        assert_eq!(gate.recv(), Ok("whole"));
        drop(jobs);
    }

    #[test]
    fn progress_wakes_where_it_can_be_seen() {
        let (wake, rung) = bell();
        let mut job = Job::<()>::spawn("steps", wake, |reporter| {
            for step in 0..=1000 {
                reporter.progress(step, 1000);
            }
        });
        // A hundred steps, the end and the farewell; then the worker's bell is gone.
        assert_eq!(rung.iter().count(), 102);
        job.poll();
        assert_eq!(job.share(), 1.0);
    }
}
