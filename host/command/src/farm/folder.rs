//! The folder of a job.

use std::fs;
use std::path::{Path, PathBuf};

use super::Job;
use crate::error::{Error, Result};
use crate::output::{write_atomically, write_error};

/// A folder with nothing in it, for a job.
#[derive(Debug)]
pub struct Folder(PathBuf);

impl Folder {
    /// A folder that is new or empty. Nothing is made yet.
    ///
    /// # Errors
    /// A folder with something in it, and what is none.
    pub fn new(path: &Path) -> Result<Self> {
        let fault = |fault: String| Error::file(path, fault);
        if path.exists() {
            let found = fs::read_dir(path)
                .map_err(|error| fault(format!("is no folder to write into: {error}; name a new one")))?;
            if found.count() > 0 {
                return Err(fault("is not empty; name a new folder".to_owned()));
            }
        }
        Ok(Folder(path.to_owned()))
    }

    /// Writes the files of a job.
    ///
    /// # Errors
    /// A folder that can't be made or written into.
    pub fn write(&self, job: &Job) -> Result<()> {
        if !self.0.exists() {
            fs::create_dir(&self.0).map_err(|error| Error::file(&self.0, write_error(&error).message))?;
        }
        let files = [
            ("job.yaml", job.template()),
            ("slurm.sh", job.array_script()),
            ("merge.sh", job.merge_script()),
            ("submit.sh", job.submit_script()),
        ];
        files.iter().try_for_each(|(name, text)| {
            write_atomically(&self.0.join(name), |out| {
                out.write_all(text.as_bytes()).map_err(|error| write_error(&error))
            })
        })
    }
}
