//! The header and the table of contents.

use super::rules::{Checked, at, each, ensure, zeros};
use crate::blob::error::BlobError;
use crate::blob::format::{Header, MAGIC, NONE, SECTION_ALIGN, Toc, VERSION, needs, section};
use crate::blob::rule::Rule;
use bytemuck::{AnyBitPattern, NoUninit};

/// The table of contents, looked up by kind.
pub(super) struct Contents<'a> {
    bytes: &'a [u8],
    table: &'a [Toc],
}

/// Where the table of contents ends.
const END: usize = size_of::<Header>() + section::ALL.len() * size_of::<Toc>();

impl<'a> Contents<'a> {
    pub fn read(bytes: &'a [u8]) -> Result<(&'a Header, Self), BlobError> {
        let (header, table) = head(bytes).map_err(at(0))?;
        each(0, table, |i, entry| {
            check_entry(table, header.length, i, entry)
        })?;
        Ok((header, Self { bytes, table }))
    }

    pub fn section<T: AnyBitPattern + NoUninit>(&self, kind: u32) -> Result<&'a [T], BlobError> {
        let bytes = self.find(kind, size_of::<T>()).map_err(at(kind))?;
        // Whole records at a multiple of 64.
        bytemuck::try_cast_slice(bytes).map_err(|_| at(kind)(Rule::SectionStride))
    }

    /// The bytes of a section with records of `stride`.
    #[inline(never)]
    fn find(&self, kind: u32, stride: usize) -> Result<&'a [u8], Rule> {
        let entry = self.table.iter().find(|t| t.kind == kind);
        let entry = entry.ok_or(Rule::SectionMissing)?;
        ensure(entry.stride as usize == stride, Rule::SectionStride)?;
        let bytes = || {
            let start = usize::try_from(entry.offset).ok()?;
            let end = usize::try_from(stop(entry)?).ok()?;
            self.bytes.get(start..end)
        };
        // As `check_entry` says, they are there.
        bytes().ok_or(Rule::TocEnd)
    }

    /// A section that holds exactly one record.
    pub fn single<T: AnyBitPattern + NoUninit>(&self, kind: u32) -> Result<&'a T, BlobError> {
        match self.section::<T>(kind)? {
            [one] => Ok(one),
            _ => Err(at(kind)(Rule::SectionSingle)),
        }
    }
}

fn head(bytes: &[u8]) -> Result<(&Header, &[Toc]), Rule> {
    let address = bytes.as_ptr().align_offset(16) == 0;
    ensure(address, Rule::HeaderAddress)?;
    let head = bytes.get(..size_of::<Header>()).ok_or(Rule::HeaderSize)?;
    let header: &Header = bytemuck::try_from_bytes(head).map_err(|_| Rule::HeaderAddress)?;
    ensure(header.magic == MAGIC, Rule::HeaderMagic)?;
    ensure(
        header.version == VERSION && cfg!(target_endian = "little"),
        Rule::HeaderVersion,
    )?;
    ensure(header.length == bytes.len() as u64, Rule::HeaderLength)?;
    ensure(header.needs & !needs::KNOWN == 0, Rule::HeaderNeeds)?;
    let spectra = header.needs & (needs::SPECTRAL | needs::DISPERSION) != 0;
    ensure(cfg!(feature = "spectral") || !spectra, Rule::SpectraLeftOut)?;
    ensure((-64..=64).contains(&header.film_exponent), Rule::HeaderFilm)?;
    zeros(&header.reserved, Rule::HeaderReserved)?;
    ensure(
        header.section_count as usize == section::ALL.len(),
        Rule::HeaderSections,
    )?;
    let table = bytes.get(size_of::<Header>()..END).ok_or(Rule::TocSize)?;
    let table = bytemuck::try_cast_slice(table).map_err(|_| Rule::HeaderAddress)?;
    Ok((header, table))
}

fn check_entry(table: &[Toc], length: u64, index: usize, entry: &Toc) -> Checked {
    ensure(entry.reserved == 0, Rule::TocReserved)?;
    ensure(entry.count < u64::from(NONE), Rule::TocCount)?;
    ensure(entry.offset.is_multiple_of(SECTION_ALIGN), Rule::TocAlign)?;
    ensure(entry.offset >= END as u64, Rule::TocStart)?;
    let stop = stop(entry).ok_or(Rule::TocEnd)?;
    ensure(stop <= length, Rule::TocEnd)?;
    // Seventeen sections: comparing each with each is still a constant.
    for other in table.iter().take(index) {
        ensure(entry.kind != other.kind, Rule::TocTwice)?;
        let end = self::stop(other).ok_or(Rule::TocEnd)?;
        let apart = entry.offset.max(other.offset) >= stop.min(end);
        ensure(apart, Rule::TocOverlap)?;
    }
    Ok(())
}

/// Where a section ends.
fn stop(entry: &Toc) -> Option<u64> {
    let size = entry.count.checked_mul(u64::from(entry.stride))?;
    entry.offset.checked_add(size)
}
