//! Numbers and names out of a binary file, little-endian, each taken only where the file has it: a count can't promise more than the file
//! holds.

use crate::error::{Error, Input, Result};

/// What is left of a file that is read from its beginning.
#[derive(Debug)]
pub struct Bytes<'a> {
    file: &'a str,
    length: usize,
    left: &'a [u8],
}

impl<'a> Bytes<'a> {
    /// All of a file; its name is for messages.
    pub fn new(file: &'a str, bytes: &'a [u8]) -> Self {
        Bytes { file, length: bytes.len(), left: bytes }
    }

    /// So many bytes.
    ///
    /// # Errors
    /// Where the file ends before.
    pub fn take(&mut self, n: usize) -> Result<&'a [u8]> {
        let Some((taken, left)) = self.left.split_at_checked(n) else {
            return Err(self.cut_off(format!("{n} bytes from byte {} on", self.length - self.left.len())));
        };
        self.left = left;
        Ok(taken)
    }

    /// As many numbers of eight bytes as `N`.
    ///
    /// # Errors
    /// Where the file ends before.
    pub fn f64s<const N: usize>(&mut self) -> Result<[f64; N]> {
        let taken = self.take(8 * N)?;
        Ok(std::array::from_fn(|n| f64::from_le_bytes(taken[8 * n..8 * n + 8].try_into().expect("8 bytes"))))
    }

    /// A whole number of four bytes.
    ///
    /// # Errors
    /// Where the file ends before.
    pub fn u32(&mut self) -> Result<u32> {
        Ok(u32::from_le_bytes(self.take(4)?.try_into().expect("4 bytes")))
    }

    /// A whole number of eight bytes.
    ///
    /// # Errors
    /// Where the file ends before.
    pub fn u64(&mut self) -> Result<u64> {
        Ok(u64::from_le_bytes(self.take(8)?.try_into().expect("8 bytes")))
    }

    /// How many of something follow, eight bytes, each of them at least `each` bytes long.
    ///
    /// # Errors
    /// Where the rest of the file is shorter than that many.
    pub fn count(&mut self, each: usize) -> Result<usize> {
        let n = self.u64()?;
        let most = (self.left.len() / each) as u64;
        if n > most {
            return Err(self.cut_off(format!("{n} entries of {each} bytes or more")));
        }
        Ok(n as usize)
    }

    /// Text up to a zero byte.
    ///
    /// # Errors
    /// Where there is none, or it isn't UTF-8.
    pub fn text(&mut self) -> Result<&'a str> {
        let Some(end) = self.left.iter().position(|&byte| byte == 0) else {
            return Err(self.cut_off("a name and its end".into()));
        };
        let name = self.take(end + 1)?;
        std::str::from_utf8(&name[..end]).map_err(|_| {
            let found = format!("{:?}", String::from_utf8_lossy(&name[..end.min(60)]));
            let remedy = "Rename the picture and make the model again.";
            Error::input(Input { file: self.file, field: "name", found, expected: "UTF-8", remedy })
        })
    }

    /// That nothing is left.
    ///
    /// # Errors
    /// Where there is more.
    pub fn end(&self) -> Result<()> {
        match self.left.len() {
            0 => Ok(()),
            more => Err(self.wrong(format!("{more} bytes after its end"), "nothing more".into())),
        }
    }

    fn cut_off(&self, expected: String) -> Error {
        self.wrong(format!("a file that was cut off, {} bytes", self.length), expected)
    }

    fn wrong(&self, found: String, expected: String) -> Error {
        let remedy = "Copy the file again, or write it again with the program that made it.";
        Error::input(Input { file: self.file, field: "length", found, expected, remedy })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_file_has_is_read_and_no_more() {
        let bytes =
            [&7u32.to_le_bytes()[..], &0.5f64.to_le_bytes(), b"a.png\0", &2u64.to_le_bytes(), &[1, 2]];
        let whole = bytes.concat();
        let mut bytes = Bytes::new("x.bin", &whole);
        assert_eq!((bytes.u32().unwrap(), bytes.f64s().unwrap(), bytes.text().unwrap()), (7, [0.5], "a.png"));
        assert_eq!((bytes.count(1).unwrap(), bytes.take(1).unwrap()), (2, &[1][..]));
        assert!(bytes.end().unwrap_err().to_string().contains("1 bytes after its end"));
        assert_eq!(bytes.take(1).unwrap(), [2]);
        bytes.end().unwrap();
        assert!(
            bytes
                .u64()
                .unwrap_err()
                .to_string()
                .contains("x.bin: length: found a file that was cut off, 28 bytes")
        );
    }

    #[test]
    fn a_count_beyond_the_file_and_a_name_without_an_end_are_refused() {
        let many = u64::MAX.to_le_bytes();
        let message = Bytes::new("x.bin", &many).count(1).unwrap_err().to_string();
        assert!(message.contains("18446744073709551615 entries of 1 bytes or more"), "{message}");
        assert!(Bytes::new("x.bin", &[3, 0, 0, 0, 0, 0, 0, 0, 1, 2]).count(1).is_err());
        assert!(Bytes::new("x.bin", b"a.png").text().is_err());
        assert!(Bytes::new("x.bin", b"\xff\0").text().unwrap_err().to_string().contains("expected UTF-8"));
    }
}
