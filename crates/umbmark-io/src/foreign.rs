//! Files of other programs, recognised by how they begin, with what makes a log of them.

use super::error::DatasetError;
use std::io::Read;
use std::path::Path;

/// What a file is shows in so many bytes.
const LONGEST: u64 = 512;

/// A kind of file that is not read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Foreign {
    /// How it begins: a place among its bytes, and what stands there.
    begins: (usize, &'static [u8]),
    /// What it is.
    what: &'static str,
    /// What makes a CSV of it.
    remedy: &'static str,
}

macro_rules! in_python {
    ($call:literal) => {
        concat!(
            "write its columns as a CSV that begins with t_s,ticks_left,ticks_right, for example in Python: `",
            $call,
            "`, and give them these names"
        )
    };
}

const PICKLE: &str = in_python!("pandas.DataFrame(pandas.read_pickle(FILE)).to_csv('log.csv', index=False)");
const UNPACK: &str = "unpack it";
const ARCHIVE: &str =
    "unpack it; of a sheet of Excel or LibreOffice, save it as CSV; of arrays of NumPy (.npz), write them as CSV";
const MATLAB: &str = "write its columns as a CSV that begins with t_s,ticks_left,ticks_right: in MATLAB \
                      `writetable(table(t_s, ticks_left, ticks_right), 'log.csv')`, or in Python `scipy.io.loadmat(FILE)` (of version 7.3, h5py)";

/// All of them; the first that fits is meant.
const FOREIGN: [Foreign; 21] = [
    is(b"MATLAB 5.0 MAT-file", "a file of MATLAB", MATLAB),
    is(b"MATLAB 7.3 MAT-file", "a file of MATLAB", MATLAB),
    is(b"\x89HDF\r\n\x1a\n", "HDF5", in_python!("pandas.read_hdf(FILE).to_csv('log.csv', index=False)")),
    is(b"PAR1\x15", "Parquet", in_python!("pandas.read_parquet(FILE).to_csv('log.csv', index=False)")),
    is(b"ARROW1", "Arrow", in_python!("pandas.read_feather(FILE).to_csv('log.csv', index=False)")),
    is(
        b"\x93NUMPY",
        "an array of NumPy",
        in_python!("pandas.DataFrame(numpy.load(FILE)).to_csv('log.csv', index=False)"),
    ),
    is(b"\x80\x02", "a pickle of Python", PICKLE),
    is(b"\x80\x03", "a pickle of Python", PICKLE),
    is(b"\x80\x04", "a pickle of Python", PICKLE),
    is(b"\x80\x05", "a pickle of Python", PICKLE),
    is(
        b"ULog\x01\x12\x35",
        "a log of PX4",
        "`ulog2csv FILE` (of the package pyulog) writes its topics as CSV; join the wheels and the reference by time",
    ),
    is(
        b"\xa3\x95\x80",
        "a log of ArduPilot",
        "`mavlogdump.py` (of the package pymavlink) writes its wheel encoders (WENC) as CSV",
    ),
    is(
        b"WPILOG",
        "a log of WPILib",
        "the Data Log Tool of WPILib writes it as CSV; name the columns t_s,ticks_left,ticks_right",
    ),
    is(b"PK\x03\x04", "a ZIP archive", ARCHIVE),
    is(b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1", "a file of Office before 2007", "save its sheet as CSV"),
    is(b"7z\xbc\xaf\x27\x1c", "a 7-Zip archive", UNPACK),
    is(b"\xfd7zXZ\0", "packed with xz", UNPACK),
    Foreign { begins: (4, b"1AY&SY"), ..is(b"", "packed with bzip2", UNPACK) },
    is(b"\x28\xb5\x2f\xfd", "packed with zstd", UNPACK),
    Foreign { begins: (257, b"ustar"), ..is(b"", "a tar archive", UNPACK) },
    is(b"%PDF", "a PDF", "a log is a CSV, an MCAP file or a bag"),
];

const fn is(begins: &'static [u8], what: &'static str, remedy: &'static str) -> Foreign {
    Foreign { begins: (0, begins), what, remedy }
}

impl Foreign {
    /// What a file is that begins like this; `None` of what may be a text.
    pub fn of(head: &[u8]) -> Option<&'static Foreign> {
        FOREIGN.iter().find(|foreign| {
            let (at, begins) = foreign.begins;
            head.get(at..).is_some_and(|rest| rest.starts_with(begins))
        })
    }

    /// The same of a file; `None` also where it cannot be read.
    pub fn of_file(file: &Path) -> Option<&'static Foreign> {
        let mut head = Vec::new();
        std::fs::File::open(file).ok()?.take(LONGEST).read_to_end(&mut head).ok()?;
        Foreign::of(&head)
    }

    /// The error of a file that should have been a text.
    pub fn refused(&self, file: &str) -> DatasetError {
        DatasetError::NotADataset { file: file.to_owned(), found: self.found(), remedy: self.remedy.into() }
    }

    /// What it is, and what to do, behind the words for why it was not read.
    pub fn told(&self) -> String {
        format!("{}; {}", self.found(), self.remedy)
    }

    fn found(&self) -> String {
        format!("it is {}", self.what)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_is_known_by_how_it_begins_and_text_is_none_of_them() {
        for foreign in &FOREIGN {
            let (at, begins) = foreign.begins;
            let mut head = vec![b' '; at];
            head.extend(begins);
            head.extend([0; 40]);
            assert_eq!(Foreign::of(&head).map(|found| found.what), Some(foreign.what));
            assert!(!begins.is_empty() && !foreign.remedy.ends_with('.'));
        }
        for text in [
            "",
            "t_s,ticks_left,ticks_right\n0,0,0\n",
            "direction,run\n",
            "# comment\n",
            "PAR1,PAR2\n0,0\n",
            "BZh,x\n",
            "MATLAB export\n",
            "{\"a\": 1}",
        ] {
            assert_eq!(Foreign::of(text.as_bytes()), None, "{text}");
        }
    }
}
