//! How much memory the machine has, as far as the system tells.

use std::{
    fs,
    path::{Path, PathBuf},
};

/// How many bytes of memory this process may come to have: those of the machine, or fewer where a control group allows fewer. Linux
/// tells; `None` on other systems.
pub(crate) fn memory_bytes() -> Option<u64> {
    memory_under(Path::new("/"))
}

/// The same, with the system's files under another folder.
fn memory_under(root: &Path) -> Option<u64> {
    let read = |path: PathBuf| fs::read_to_string(path).ok();
    let total = total_of(&read(root.join("proc/meminfo"))?)?;
    let groups = read(root.join("proc/self/cgroup")).unwrap_or_default();
    let limits = limit_files(&groups).into_iter().filter_map(|path| read(root.join(path))?.trim().parse().ok());
    // Version 1 says "no limit" by a number of exabytes, version 2 by the word `max`: neither is the smallest number.
    Some(limits.fold(total, u64::min))
}

/// The line `MemTotal` of /proc/meminfo, in bytes; it counts in kibibytes.
fn total_of(meminfo: &str) -> Option<u64> {
    let line = meminfo.lines().find_map(|line| line.strip_prefix("MemTotal:"))?;
    line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()?.checked_mul(1024)
}

/// The files, from the root of the file system, that may hold limits for a process in these control groups: its own groups' and those
/// of all groups above them.
fn limit_files(groups: &str) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for line in groups.lines() {
        // NUMBER:CONTROLLERS:PATH, and for version 2 without controllers.
        let mut fields = line.splitn(3, ':').skip(1);
        let (Some(controllers), Some(path)) = (fields.next(), fields.next()) else { continue };
        let (folder, file) = match controllers {
            "" => ("sys/fs/cgroup", "memory.max"),
            _ if controllers.split(',').any(|controller| controller == "memory") => {
                ("sys/fs/cgroup/memory", "memory.limit_in_bytes")
            }
            _ => continue,
        };
        let own = Path::new(path.trim_start_matches('/'));
        files.extend(own.ancestors().map(|group| Path::new(folder).join(group).join(file)));
    }
    files
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_smallest_limit_of_the_groups_counts() {
        let root = std::env::temp_dir().join(format!("shadow-cli-{}-machine", std::process::id()));
        let write = |path: &str, text: &str| {
            let path = root.join(path);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        };
        assert_eq!(memory_under(&root), None);
        write("proc/meminfo", "MemFree: 5 kB\nMemTotal:       16384 kB\n");
        assert_eq!(memory_under(&root), Some(16 << 20));
        write("proc/self/cgroup", "4:memory:/old/one\n0::/new/two\n");
        write("sys/fs/cgroup/new/two/memory.max", "max\n");
        write("sys/fs/cgroup/memory/old/one/memory.limit_in_bytes", "9223372036854771712\n");
        assert_eq!(memory_under(&root), Some(16 << 20), "no limit is none");
        write("sys/fs/cgroup/new/memory.max", "8388608\n");
        assert_eq!(memory_under(&root), Some(8 << 20), "a group above limits too");
        write("sys/fs/cgroup/memory/old/one/memory.limit_in_bytes", "4194304\n");
        assert_eq!(memory_under(&root), Some(4 << 20));
        fs::remove_dir_all(root).unwrap();
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn this_machine_has_memory() {
        // The smallest machine that could have compiled this has more than 64 MiB.
        assert!(memory_bytes().is_some_and(|bytes| bytes > 64 << 20));
    }
}
