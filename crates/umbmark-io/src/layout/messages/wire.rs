//! How numbers and texts lie in messages of ROS: CDR, where each number is aligned to its size, and the packed form of ROS 1.

use super::schema::Primitive;
use re_cdr::{CdrEndian, CdrReader};

/// Why a message could not be read to its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::layout) enum Broken {
    /// It ends before its type does.
    Short,
    /// A text is not UTF-8.
    Text,
}

/// A message that is read from its first byte on.
pub(in crate::layout) trait Wire {
    /// Bytes behind which it stands.
    fn position(&self) -> usize;
    /// Steps over `count` numbers of a size.
    fn skip(&mut self, size: usize, count: usize) -> Result<(), Broken>;
    fn number(&mut self, primitive: Primitive) -> Result<f64, Broken>;
    /// How long a list or a text is.
    fn length(&mut self) -> Result<usize, Broken>;
    fn text(&mut self) -> Result<&str, Broken>;
    fn skip_text(&mut self) -> Result<(), Broken> {
        let length = self.length()?;
        self.skip(1, length)
    }
}

impl<B: CdrEndian> Wire for CdrReader<'_, B> {
    fn position(&self) -> usize {
        CdrReader::position(self)
    }

    fn skip(&mut self, size: usize, count: usize) -> Result<(), Broken> {
        if count == 0 {
            return Ok(());
        }
        self.align(size)?;
        self.read_bytes(size.saturating_mul(count))?;
        Ok(())
    }

    fn number(&mut self, primitive: Primitive) -> Result<f64, Broken> {
        Ok(match primitive {
            Primitive::Bool | Primitive::U8 => self.read_u8()?.into(),
            Primitive::I8 => self.read_i8()?.into(),
            Primitive::I16 => self.read_i16()?.into(),
            Primitive::U16 => self.read_u16()?.into(),
            Primitive::I32 => self.read_i32()?.into(),
            Primitive::U32 => self.read_u32()?.into(),
            Primitive::I64 => self.read_i64()? as f64,
            Primitive::U64 => self.read_u64()? as f64,
            Primitive::F32 => self.read_f32()?.into(),
            Primitive::F64 => self.read_f64()?,
        })
    }

    fn length(&mut self) -> Result<usize, Broken> {
        Ok(self.read_u32()? as usize)
    }

    fn text(&mut self) -> Result<&str, Broken> {
        Ok(self.read_str()?)
    }
}

impl From<re_cdr::Error> for Broken {
    fn from(error: re_cdr::Error) -> Broken {
        match error {
            re_cdr::Error::Utf8(_) => Broken::Text,
            _ => Broken::Short,
        }
    }
}

/// A message of ROS 1: little endian, nothing between fields.
///
/// Source: <https://wiki.ros.org/msg> and genpy.
pub(in crate::layout) struct Packed<'d> {
    data: &'d [u8],
    position: usize,
}

impl<'d> Packed<'d> {
    pub fn new(data: &'d [u8]) -> Packed<'d> {
        Packed { data, position: 0 }
    }

    fn take(&mut self, length: usize) -> Result<&'d [u8], Broken> {
        let end = self.position.checked_add(length).ok_or(Broken::Short)?;
        let bytes = self.data.get(self.position..end).ok_or(Broken::Short)?;
        self.position = end;
        Ok(bytes)
    }

    fn bytes<const N: usize>(&mut self) -> Result<[u8; N], Broken> {
        self.take(N)?.try_into().map_err(|_| Broken::Short)
    }
}

impl Wire for Packed<'_> {
    fn position(&self) -> usize {
        self.position
    }

    fn skip(&mut self, size: usize, count: usize) -> Result<(), Broken> {
        self.take(size.saturating_mul(count)).map(|_| ())
    }

    fn number(&mut self, primitive: Primitive) -> Result<f64, Broken> {
        Ok(match primitive {
            Primitive::Bool | Primitive::U8 => u8::from_le_bytes(self.bytes()?).into(),
            Primitive::I8 => i8::from_le_bytes(self.bytes()?).into(),
            Primitive::I16 => i16::from_le_bytes(self.bytes()?).into(),
            Primitive::U16 => u16::from_le_bytes(self.bytes()?).into(),
            Primitive::I32 => i32::from_le_bytes(self.bytes()?).into(),
            Primitive::U32 => u32::from_le_bytes(self.bytes()?).into(),
            Primitive::I64 => i64::from_le_bytes(self.bytes()?) as f64,
            Primitive::U64 => u64::from_le_bytes(self.bytes()?) as f64,
            Primitive::F32 => f32::from_le_bytes(self.bytes()?).into(),
            Primitive::F64 => f64::from_le_bytes(self.bytes()?),
        })
    }

    fn length(&mut self) -> Result<usize, Broken> {
        Ok(u32::from_le_bytes(self.bytes()?) as usize)
    }

    fn text(&mut self) -> Result<&str, Broken> {
        let length = self.length()?;
        std::str::from_utf8(self.take(length)?).map_err(|_| Broken::Text)
    }
}
