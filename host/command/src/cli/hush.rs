//! Drivers, layers and the libraries they load write to standard error whatever they like. It is kept from the user,
//! unless warnings are asked for.

use std::any::Any;

/// For [`eyerays::gpu::Around`].
pub(super) fn around() -> Box<dyn Any> {
    Box::new(Hush::new())
}

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

#[cfg(all(test, unix))]
mod tests {
    use same_file::Handle;

    use super::*;

    #[test]
    fn standard_error_goes_nowhere_until_the_last_of_many_at_once_is_gone() {
        let before = Handle::stderr().unwrap();
        let longest = Hush::new();
        std::thread::scope(|scope| {
            for _ in 0..4 {
                scope.spawn(|| drop(Hush::new()));
            }
        });
        let hushed = Handle::stderr().unwrap();
        drop(longest);
        assert_eq!(hushed, Handle::from_path("/dev/null").unwrap());
        assert_eq!(Handle::stderr().unwrap(), before);
    }
}
