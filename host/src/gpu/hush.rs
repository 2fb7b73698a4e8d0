//! Drivers, layers and the libraries they load write to standard error whatever they like. It is kept from the user,
//! unless warnings are asked for.

/// Keeps silent whatever writes to standard error, until the last one is dropped.
#[must_use]
pub(super) struct Hush {
    #[cfg(unix)]
    _redirected: Option<unix::Redirected>,
}

impl Hush {
    pub fn new() -> Hush {
        Hush {
            #[cfg(unix)]
            _redirected: (!tracing::enabled!(tracing::Level::WARN)).then(unix::Redirected::new),
        }
    }
}

#[cfg(unix)]
mod unix {
    use std::fs::File;
    use std::io;
    use std::os::fd::OwnedFd;
    use std::sync::{Mutex, MutexGuard, PoisonError};

    use rustix::stdio::{dup2_stderr, stderr};

    /// How many want silence, and standard error as it was before the first of them.
    struct State {
        count: usize,
        before: Option<OwnedFd>,
    }

    static STATE: Mutex<State> = Mutex::new(State { count: 0, before: None });

    fn state() -> MutexGuard<'static, State> {
        STATE.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Standard error goes nowhere.
    pub struct Redirected;

    impl Redirected {
        pub fn new() -> Self {
            let mut state = state();
            if state.count == 0 {
                // Without a free file descriptor the user reads too much, and that is all.
                state.before = redirect().ok();
            }
            state.count += 1;
            Redirected
        }
    }

    impl Drop for Redirected {
        fn drop(&mut self) {
            let mut state = state();
            state.count -= 1;
            if state.count == 0
                && let Some(before) = state.before.take()
            {
                // It was open a moment ago.
                let _ = dup2_stderr(before);
            }
        }
    }

    /// Standard error as it was.
    fn redirect() -> io::Result<OwnedFd> {
        let nowhere = File::options().write(true).open("/dev/null")?;
        let before = stderr().try_clone_to_owned()?;
        dup2_stderr(nowhere)?;
        Ok(before)
    }
}
