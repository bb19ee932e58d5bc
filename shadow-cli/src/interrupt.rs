//! What happens when the person, or the system, ends the program while it works: no half-written file stays behind.

use std::{
    collections::BTreeSet,
    fs,
    path::{Path, PathBuf},
    sync::{Mutex, PoisonError},
};

/// The exit code of a program that was interrupted: 128 and the number of SIGINT, as shells report it.
pub(crate) const INTERRUPTED: i32 = 130;

/// The files that exist and are not complete.
static UNFINISHED: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

/// From now on an interruption (Ctrl-C; on Unix also SIGTERM and SIGHUP) removes unfinished files and ends the program.
pub(crate) fn remove_unfinished_files_when_interrupted() {
    let installed = ctrlc::set_handler(|| {
        // The lock is never given back: nobody can begin another file from here on.
        let mut unfinished = UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner);
        remove(&mut unfinished);
        // At once, without what libraries do at their end: a graphics driver's threads may be at work meanwhile, and crash.
        signal_hook::low_level::exit(INTERRUPTED);
    });
    // Where there can be no handler, an interruption ends the program all the same, if not as cleanly.
    drop(installed);
}

/// Removes files. What cannot be removed now cannot be removed at all.
fn remove(unfinished: &mut BTreeSet<PathBuf>) {
    for path in std::mem::take(unfinished) {
        let _ = fs::remove_file(path);
    }
}

/// Says that a file is about to be made and is not complete; before it is there, so that no interruption comes too early.
pub(crate) fn begin_file(path: &Path) {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner).insert(path.into());
}

/// Says that a file has its final name, or is gone.
pub(crate) fn end_file(path: &Path) {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner).remove(path);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unfinished_files_are_removed_and_no_others() {
        let folder = std::env::temp_dir().join(format!("shadow-cli-{}-interrupt", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let [unfinished, finished, missing] = ["unfinished", "finished", "missing"].map(|name| folder.join(name));
        fs::write(&unfinished, "half").unwrap();
        fs::write(&finished, "whole").unwrap();
        let mut files = BTreeSet::from([missing, unfinished.clone()]);
        remove(&mut files);
        assert!(files.is_empty() && !unfinished.exists() && finished.exists());
        fs::remove_dir_all(folder).unwrap();
    }
}
