//! How much memory a command may take: said before work that needs much, and kept.

use std::time::Duration;

/// Work that needs less than this is not announced \[bytes\].
const MUCH: u64 = 1 << 30;
/// How often the memory of the process is looked at.
const EVERY: Duration = Duration::from_millis(20);

/// So much memory, and no more.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Budget {
    /// \[bytes\]
    bytes: u64,
    /// Whether the user said it; else it is half of what the machine has.
    said: bool,
}

impl Budget {
    /// What the user allows, or half of what the machine has; `None` where neither is known.
    pub fn of(said: Option<u64>) -> Option<Budget> {
        let own = said.map(|bytes| Budget { bytes, said: true });
        own.or_else(|| Some(Budget { bytes: memory_of_machine()? / 2, said: false }))
    }

    /// In words.
    fn words(self) -> String {
        let (size, whence) = (size(self.bytes), if self.said { "" } else { ", half of what this machine has" });
        format!("--memory ({size}{whence})")
    }

    /// What to do about work that needs more.
    fn remedy(self) -> &'static str {
        "allow more by --memory SIZE if the machine has it, or give it less: fewer or shorter runs, or poses and counts at a lower rate"
    }

    /// Refuses work that needs more than there may be; what to tell before work that needs much.
    pub fn allow(self, needed: u64) -> anyhow::Result<Option<String>> {
        if needed > self.bytes {
            let (size, words, remedy) = (size(needed), self.words(), self.remedy());
            anyhow::bail!("this needs about {size} of memory, which is more than {words}; {remedy}");
        }
        Ok((needed >= MUCH).then(|| format!("this needs about {} of memory", size(needed))))
    }

    /// Ends the process with one error, and without unfinished files, as soon as it holds more than this.
    pub fn keep(self) {
        let watch = move || {
            while let Some(held) = memory_of_process() {
                if held > self.bytes {
                    umbmark_io::take_away_unfinished();
                    eprint(&format!(
                        "error: stopped, because it took more memory than {}; {}",
                        self.words(),
                        self.remedy()
                    ));
                    std::process::exit(1);
                }
                std::thread::sleep(EVERY);
            }
        };
        // A machine that starts no thread says so where the work begins.
        let _ = std::thread::Builder::new().name("memory".into()).spawn(watch);
    }
}

fn eprint(text: &str) {
    use std::io::Write;
    let _ = writeln!(std::io::stderr(), "{text}");
}

/// As people say it.
fn size(bytes: u64) -> String {
    let bytes = bytes as f64;
    if bytes >= 1e9 { format!("{:.1} GB", bytes / 1e9) } else { format!("{:.0} MB", (bytes / 1e6).ceil()) }
}

/// The memory of the machine, or of the group of processes that is allowed less \[bytes\].
fn memory_of_machine() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/meminfo").ok()?;
    let machine = 1024
        * text
            .lines()
            .find_map(|line| line.strip_prefix("MemTotal:")?.split_whitespace().next()?.parse::<u64>().ok())?;
    let group = std::fs::read_to_string("/sys/fs/cgroup/memory.max").ok().and_then(|text| text.trim().parse().ok());
    Some(group.map_or(machine, |group: u64| group.min(machine)))
}

/// What the process holds \[bytes\].
fn memory_of_process() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/self/status").ok()?;
    let held =
        text.lines().find_map(|line| line.strip_prefix("VmRSS:")?.split_whitespace().next()?.parse::<u64>().ok())?;
    Some(1024 * held)
}

/// A size as people write it: 2GB, 500 MB, 1.5GiB, or bytes.
pub fn size_argument(text: &str) -> Result<u64, String> {
    const UNITS: [(&str, f64); 9] = [
        ("KiB", 1024.0),
        ("MiB", 1_048_576.0),
        ("GiB", 1_073_741_824.0),
        ("TiB", 1_099_511_627_776.0),
        ("kB", 1e3),
        ("KB", 1e3),
        ("MB", 1e6),
        ("GB", 1e9),
        ("TB", 1e12),
    ];
    let text = text.trim();
    let unit = UNITS.iter().find_map(|(name, bytes)| Some((text.strip_suffix(name)?, *bytes)));
    let (number, unit) = unit.unwrap_or((text.strip_suffix('B').unwrap_or(text), 1.0));
    let bytes = number.trim().parse::<f64>().map_or(f64::NAN, |number| number * unit);
    let least = LEAST as f64;
    match bytes >= least && bytes <= 1e18 {
        true => Ok(bytes as u64),
        false => Err(format!("expected a size of {} or more, such as 2GB or 500MB", size(LEAST))),
    }
}

/// With less, no command ends \[bytes\].
const LEAST: u64 = 50_000_000;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_read_as_people_write_them() {
        for (text, bytes) in [
            ("2GB", 2_000_000_000),
            ("500 MB", 500_000_000),
            ("1.5GiB", 1_610_612_736),
            ("60000000", 60_000_000),
            ("6e7B", 60_000_000),
        ] {
            assert_eq!(size_argument(text), Ok(bytes), "{text}");
        }
        for text in ["", "GB", "2 gigs", "-3GB", "NaN", "inf", "1MB", "1e30GB"] {
            assert!(size_argument(text).unwrap_err().contains("50 MB or more"), "{text}");
        }
    }

    #[test]
    fn work_is_allowed_announced_or_refused_by_what_it_needs() {
        let budget = Budget { bytes: 3_000_000_000, said: true };
        assert_eq!(budget.allow(1_000_000_000).unwrap(), None);
        assert_eq!(budget.allow(2_950_000_000).unwrap().unwrap(), "this needs about 3.0 GB of memory");
        let refused = budget.allow(3_100_000_000).unwrap_err().to_string();
        assert!(refused.contains("3.1 GB") && refused.contains("--memory (3.0 GB)"), "{refused}");
        let half = Budget { said: false, ..budget }.allow(u64::MAX).unwrap_err().to_string();
        assert!(half.contains("half of what this machine has"), "{half}");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn the_memory_of_the_process_and_of_the_machine_is_known() {
        let (process, machine) = (memory_of_process().unwrap(), memory_of_machine().unwrap());
        assert!(process > 1_000_000 && process < machine, "{process} {machine}");
        assert_eq!(Budget::of(None).unwrap().bytes, machine / 2);
    }
}
