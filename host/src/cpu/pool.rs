//! The threads that the kernels run on.

use crate::error::{Error, Result};

/// Threads to install work in; 0 is one a core.
pub fn pool(threads: usize) -> Result<rayon::ThreadPool> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    pool.map_err(|e| Error::Threads { threads, message: e.to_string() })
}
