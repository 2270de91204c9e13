//! Work on a thread of its own, without the interpreter's lock: other Python threads go on, progress is told, and Ctrl+C stops it.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use counterpoise_host::files;
use counterpoise_host::workers::{QuietPool, start_thread};
use counterpoise_pipeline::{PipelineStage, World};
use counterpoise_pool::Pool;
use pyo3::prelude::*;

use crate::failures::exception;

/// Interval at which the interpreter is asked whether Ctrl+C was pressed.
const LISTEN: Duration = Duration::from_millis(50);
/// Stack of the working thread: as the main thread of a program has it.
const STACK: usize = 8 << 20;

enum Message<T> {
    Progress { stage: String, done: usize, of: usize },
    Done(anyhow::Result<T>),
}

type ProgressCallback = Box<dyn Fn(&str, usize, usize) + Send + Sync>;

/// World of a computation in the background: the files beside the project, all processors, and a callback for its progress.
pub struct BackgroundWorld {
    folder: PathBuf,
    tell: ProgressCallback,
    is_stopped: Arc<AtomicBool>,
}

impl World for BackgroundWorld {
    fn read(&self, name: &str) -> Result<Vec<u8>, String> {
        let why = |error| format!("cannot read {}: {error}", self.folder.join(name).display());
        files::read_reference(&self.folder, name).map_err(why)
    }

    fn pool(&self) -> &dyn Pool {
        &QuietPool
    }

    fn begins(&self, step: PipelineStage) {
        (self.tell)(step.name(), 0, 1);
    }

    fn ends(&self, _step: PipelineStage) {}
}

impl Pool for BackgroundWorld {
    fn run(&self, count: usize, job: &(dyn Fn(usize) + Sync)) {
        QuietPool.run(count, job);
    }

    fn is_cancelled(&self) -> bool {
        self.is_stopped.load(Ordering::SeqCst)
    }

    fn progress(&self, stage: &str, done: usize, of: usize) {
        (self.tell)(stage, done, of);
    }
}

/// Runs a job beside the files of a folder. `progress(stage, done, of)` is called on the calling thread as the work goes on.
///
/// Ctrl+C raises `KeyboardInterrupt` at once; work that looks at its surroundings ends soon after, other work runs to its end in the background.
///
/// # Errors
/// Those of the job as exceptions, and what `progress` raises.
pub fn run<T: Send + 'static>(
    py: Python<'_>,
    folder: PathBuf,
    progress: Option<&Bound<'_, PyAny>>,
    job: impl FnOnce(&BackgroundWorld) -> anyhow::Result<T> + Send + 'static,
) -> PyResult<T> {
    let (sender, receiver) = channel();
    let is_stopped = Arc::new(AtomicBool::new(false));
    let surroundings = BackgroundWorld { folder, tell: teller(&sender), is_stopped: Arc::clone(&is_stopped) };
    start_thread("counterpoise", STACK, move || {
        let done = job(&surroundings);
        // the receiver is gone after Ctrl+C
        let _ = sender.send(Message::Done(done));
    })?;
    let answer = listen(py, receiver, progress);
    if answer.is_err() {
        is_stopped.store(true, Ordering::SeqCst);
    }
    answer
}

fn teller<T: Send + 'static>(sender: &Sender<Message<T>>) -> ProgressCallback {
    let sender = Mutex::new(sender.clone());
    Box::new(move |stage, done, of| {
        if let Ok(sender) = sender.lock() {
            let _ = sender.send(Message::Progress { stage: stage.to_owned(), done, of });
        }
    })
}

fn listen<T: Send>(
    py: Python<'_>,
    receiver: Receiver<Message<T>>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<T> {
    // A receiver serves one thread at a time, which a lock proves to the compiler.
    let receiver = Mutex::new(receiver);
    loop {
        let heard = py.detach(|| match receiver.lock() {
            Ok(receiver) => receiver.recv_timeout(LISTEN),
            Err(_) => Err(RecvTimeoutError::Disconnected),
        });
        py.check_signals()?;
        match heard {
            Ok(Message::Progress { stage, done, of }) => {
                progress.map(|progress| progress.call1((stage, done, of))).transpose()?;
            }
            Ok(Message::Done(done)) => return done.map_err(|error| exception(py, &error)),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => {
                let why = anyhow::anyhow!("the work ended without a result: please report this as a defect");
                return Err(exception(py, &why));
            }
        }
    }
}
