//! Packs a file for [`kalmanscope_unpack::Unpacker`]: `pack FROM TO`.

use std::io::Write;
use std::{env, error, fs};

use lzma_rust2::{LzmaOptions, LzmaWriter};

/// WebAssembly repeats itself from end to end: the window holds all of it.
const WINDOW: u32 = 1 << 24;

fn main() -> Result<(), Box<dyn error::Error>> {
    let [from, to] = env::args().skip(1).collect::<Vec<_>>().try_into().map_err(|_| "usage: pack FROM TO")?;
    let bytes = fs::read(from)?;
    // By trying: as good as the most thorough settings of all, within seconds. Instructions are not aligned (`pb`), and what
    // the next byte is depends on the whole byte before it (`lc`).
    let options = LzmaOptions { dict_size: WINDOW, lc: 8, pb: 0, nice_len: 273, ..LzmaOptions::with_preset(9) };
    let mut writer = LzmaWriter::new_use_header(Vec::new(), &options, Some(bytes.len() as u64))?;
    writer.write_all(&bytes)?;
    fs::write(to, writer.finish()?)?;
    Ok(())
}
