//! Files compressed by gzip.

use super::error::DatasetError;
use flate2::read::MultiGzDecoder;
use std::io::Read;

/// More than this is not unpacked \[bytes\]: a few kilobytes can stand for gigabytes of nothing.
const LARGEST: u64 = 1 << 30;

/// The bytes that a compressed file stands for; others as they are.
pub(super) fn unpacked(file: &str, bytes: Vec<u8>) -> Result<Vec<u8>, DatasetError> {
    unpacked_up_to(file, bytes, LARGEST)
}

fn unpacked_up_to(file: &str, bytes: Vec<u8>, largest: u64) -> Result<Vec<u8>, DatasetError> {
    if !bytes.starts_with(&[0x1f, 0x8b]) {
        return Ok(bytes);
    }
    let mut plain = Vec::new();
    let read = MultiGzDecoder::new(&bytes[..]).take(largest + 1).read_to_end(&mut plain);
    let reason = match read {
        Err(error) => format!("is damaged after {} bytes of its text ({error}); pack it again", plain.len()),
        Ok(_) if plain.len() as u64 > largest => {
            format!("unpacks to more than {largest} bytes; unpack it yourself if that is meant")
        }
        Ok(_) => return Ok(plain),
    };
    Err(DatasetError::Packed { file: file.to_owned(), reason })
}

#[cfg(test)]
mod tests {
    use super::*;
    use flate2::{Compression, write::GzEncoder};
    use std::io::Write;

    fn packed(text: &[u8]) -> Vec<u8> {
        let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
        encoder.write_all(text).unwrap();
        encoder.finish().unwrap()
    }

    #[test]
    fn packed_text_is_unpacked_and_other_text_is_not_touched() {
        assert_eq!(unpacked("f", packed(b"a,b\n1,2\n")).unwrap(), b"a,b\n1,2\n");
        assert_eq!(unpacked("f", b"a,b\n".to_vec()).unwrap(), b"a,b\n");
        let both = [packed(b"a,b\n"), packed(b"1,2\n")].concat();
        assert_eq!(unpacked("f", both).unwrap(), b"a,b\n1,2\n");
    }

    #[test]
    fn a_bomb_is_refused_before_it_fills_the_memory() {
        let bomb = packed(&vec![0; 1 << 20]);
        assert!(bomb.len() < 2000);
        let said = unpacked_up_to("f", bomb, 1000).unwrap_err().to_string();
        assert_eq!(said, "f: unpacks to more than 1000 bytes; unpack it yourself if that is meant");
    }

    #[test]
    fn a_cut_file_is_refused() {
        let whole = packed(b"0123456789");
        let said = unpacked("f", whole[..whole.len() - 9].to_vec()).unwrap_err().to_string();
        assert!(said.starts_with("f: is damaged after "), "{said}");
    }
}
