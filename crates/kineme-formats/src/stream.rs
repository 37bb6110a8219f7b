//! Bytes on their way into a table.

use std::collections::VecDeque;
use std::io::Read;

/// Bytes of which the first were looked at.
pub(crate) struct Peeked<R> {
    head: Vec<u8>,
    rest: R,
}

impl<R: Read> Peeked<R> {
    /// Looks whether the bytes begin with `magic`, and awaits no more of a stream than tells.
    pub fn new(mut rest: R, magic: &[u8]) -> std::io::Result<Self> {
        let mut head = Vec::new();
        while magic.starts_with(&head) && head.len() < magic.len() {
            if rest.by_ref().take(1).read_to_end(&mut head)? == 0 {
                break;
            }
        }
        Ok(Self { head, rest })
    }

    /// The first bytes, as many as were looked at.
    pub fn head(&self) -> &[u8] {
        &self.head
    }
}

impl<R: Read> Read for Peeked<R> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        // In one piece with what follows: `csv` looks for a byte order mark in the first piece.
        let first = self.head.len().min(buffer.len());
        let (head, rest) = buffer.split_at_mut(first);
        head.copy_from_slice(&self.head[..first]);
        self.head.drain(..first);
        Ok(first + self.rest.read(rest)?)
    }
}

/// Passes bytes on and notes where lines begin: `csv` counts neither empty lines nor CRLF as an editor does.
pub(crate) struct LineStarts<R> {
    inner: R,
    offset: u64,
    line: usize,
    fresh: bool,
    /// Offset of the first byte and number of each line that is not empty, those yet to be asked for.
    starts: VecDeque<(u64, usize)>,
}

impl<R> LineStarts<R> {
    pub fn new(inner: R) -> Self {
        Self {
            inner,
            offset: 0,
            line: 1,
            fresh: true,
            starts: VecDeque::new(),
        }
    }

    /// The number, from 1, of the first line that is not empty and begins at `offset` or later.
    pub fn line_from(&mut self, offset: u64) -> usize {
        while self.starts.front().is_some_and(|(at, _)| *at < offset) {
            self.starts.pop_front();
        }
        self.starts.front().map_or(self.line, |(_, line)| *line)
    }
}

impl<R: Read> Read for LineStarts<R> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        let count = self.inner.read(buffer)?;
        for &byte in &buffer[..count] {
            let ends = matches!(byte, b'\n' | b'\r');
            if self.fresh && !ends {
                self.starts.push_back((self.offset, self.line));
            }
            self.fresh = ends;
            self.line += usize::from(byte == b'\n');
            self.offset += 1;
        }
        Ok(count)
    }
}
