//! Splits rows with quotes (RFC 4180) by csv-core.

use csv_core::{ReadRecordResult, ReaderBuilder, Terminator};

pub(super) struct Quoted {
    reader: csv_core::Reader,
    text: Vec<u8>,
    written: usize,
    ends: Vec<usize>,
    fields: usize,
}

impl Quoted {
    pub(super) fn new(delimiter: u8) -> Self {
        let reader =
            ReaderBuilder::new().delimiter(delimiter).terminator(Terminator::Any(b'\n')).build();
        Self { reader, text: Vec::new(), written: 0, ends: Vec::new(), fields: 0 }
    }

    /// Splits the first line of a record. Returns `false` if it ends inside quotes; the next line
    /// then belongs to the record too.
    pub(super) fn begin(&mut self, line: &[u8]) -> bool {
        self.reader.reset();
        self.written = 0;
        self.fields = 0;
        self.extend(line)
    }

    /// Continues the record with a line that follows inside quotes.
    pub(super) fn extend(&mut self, line: &[u8]) -> bool {
        let (text, ends) = (self.written + line.len() + 1, self.fields + line.len() + 2);
        self.text.resize(self.text.len().max(text), 0);
        self.ends.resize(self.ends.len().max(ends), 0);
        self.feed(line);
        self.feed(b"\n") == ReadRecordResult::Record
    }

    fn feed(&mut self, input: &[u8]) -> ReadRecordResult {
        let (text, ends) = (&mut self.text[self.written..], &mut self.ends[self.fields..]);
        let (result, _, written, fields) = self.reader.read_record(input, text, ends);
        self.written += written;
        self.fields += fields;
        result
    }

    /// The length of the record so far.
    pub(super) fn text_bytes(&self) -> usize {
        self.written
    }

    /// The fields of the record without their quotes.
    pub(super) fn fields(&self) -> impl ExactSizeIterator<Item = &[u8]> {
        let mut start = 0;
        self.ends[..self.fields].iter().map(move |&end| {
            let field = &self.text[start..end];
            start = end;
            field
        })
    }
}
