//! How much physical memory a part of the work takes, as far as the system tells: Linux does.

use std::fs;

/// Writing [`RESET_PEAK`] here makes the high-water mark the memory that is resident now (proc(5)); every process may do so with itself.
const CLEAR_REFS: &str = "/proc/self/clear_refs";
/// What resets the high-water mark, and nothing else.
const RESET_PEAK: &str = "5";
/// Where the marks can be read.
const STATUS: &str = "/proc/self/status";
/// The status counts in kibibytes and calls them kB.
const KIB: u64 = 1024;

/// A part of the work whose memory is watched, from [`Self::begin`] to [`Self::bytes`].
pub(crate) struct PeakWatch {
    /// The bytes that were resident before.
    before: u64,
}

impl PeakWatch {
    /// Begins to watch; `None` where the system does not tell.
    pub(crate) fn begin() -> Option<Self> {
        fs::write(CLEAR_REFS, RESET_PEAK).ok()?;
        Some(Self { before: status("VmRSS:")? })
    }

    /// How many bytes more than at the beginning were resident at once since then.
    ///
    /// Memory that the process had got before and uses again is not counted. The system counts a thread's last few pages late, which makes
    /// the number uncertain by a fraction of a megabyte.
    pub(crate) fn bytes(&self) -> Option<u64> {
        Some(status("VmHWM:")?.saturating_sub(self.before))
    }
}

/// A line of the process's status, in bytes.
fn status(field: &str) -> Option<u64> {
    bytes_of(&fs::read_to_string(STATUS).ok()?, field)
}

fn bytes_of(status: &str, field: &str) -> Option<u64> {
    let value = status.lines().find_map(|line| line.strip_prefix(field))?;
    value.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()?.checked_mul(KIB)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_of_the_status_is_kibibytes() {
        let status = "Name:\tshadow\nVmHWM:\t   2048 kB\nVmRSS:\t   1024 kB\n";
        assert_eq!((bytes_of(status, "VmHWM:"), bytes_of(status, "VmRSS:")), (Some(2 << 20), Some(1 << 20)));
        assert_eq!(bytes_of(status, "VmSwap:"), None);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn the_peak_is_counted_from_the_beginning_and_outlives_what_made_it() {
        const BYTES: usize = 64 << 20;
        let touched = |bytes: usize| std::hint::black_box(vec![1_u8; bytes]).len();
        // A larger peak before the beginning does not count.
        touched(4 * BYTES);
        let watch = PeakWatch::begin().unwrap();
        touched(BYTES);
        let peak = watch.bytes().unwrap() as usize;
        // Other tests run in this process too, so that there is no telling how much more it is.
        assert!(peak >= BYTES * 9 / 10, "{peak}");
    }
}
