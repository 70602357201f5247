//! Sound files (RIFF/WAVE, as every recorder writes them).

use std::io::Cursor;

use kalmanscope_filters::lists::numbers;

use super::{Column, ImportError, MOST, Result, Table};

const FORM: &str = "sound";

pub(super) fn table(bytes: &[u8]) -> Result<Table> {
    let bad = |error: hound::Error| ImportError::Sound(error.to_string());
    let mut reader = hound::WavReader::new(bytes).map_err(bad)?;
    let hound::WavSpec { channels, sample_rate, bits_per_sample, sample_format } = reader.spec();
    if channels == 0 || sample_rate == 0 {
        return Err(ImportError::Sound("it has no channel or no rate".to_owned()));
    }
    let (rate, channels) = (f64::from(sample_rate), usize::from(channels));
    let most = MOST * channels;
    let values: Vec<f64> = match sample_format {
        hound::SampleFormat::Float => {
            reader.samples::<f32>().take(most).map(|x| x.map(f64::from)).collect::<Result<_, _>>().map_err(bad)?
        }
        hound::SampleFormat::Int => {
            let full = f64::from(1_u32 << bits_per_sample.saturating_sub(1).min(31));
            let share = |x: Result<i32, _>| x.map(|x| f64::from(x) / full);
            reader.samples::<i32>().take(most).map(share).collect::<Result<_, _>>().map_err(bad)?
        }
    };
    let rows = values.len() / channels;
    if rows == 0 {
        return Err(ImportError::Empty);
    }
    let seconds = rows as f64 / rate;
    let is_cut = u64::from(reader.duration()) > rows as u64;
    let remark = is_cut.then(|| format!("the sound is longer: its first {seconds:.1} s were read"));
    let column = |channel: usize| {
        let name = if channels == 1 { "sound".to_owned() } else { format!("sound {}", channel + 1) };
        Column::of_header(&name, None, values.iter().skip(channel).step_by(channels).take(rows).copied().collect())
    };
    let time = Column::of_header("t", Some("s"), numbers(rows, &|k| k as f64 / rate));
    let columns = std::iter::once(time).chain((0..channels).map(column)).collect();
    let form = format!("{FORM}: {sample_rate} samples a second, {bits_per_sample} bits");
    Ok(Table::of_columns(&form, columns, remark.into_iter().collect()))
}

/// The file of a sound with one channel: RIFF/WAVE with floating numbers.
///
/// # Errors
/// [`ImportError::Sound`] for one too long for such a file.
pub fn wav(rate: u32, samples: &[f32]) -> Result<Vec<u8>> {
    let sample_format = hound::SampleFormat::Float;
    let spec = hound::WavSpec { channels: 1, sample_rate: rate, bits_per_sample: 32, sample_format };
    let mut bytes = Cursor::new(Vec::new());
    let written = hound::WavWriter::new(&mut bytes, spec).and_then(|mut writer| {
        samples.iter().try_for_each(|x| writer.write_sample(*x))?;
        writer.finalize()
    });
    written.map_err(|error| ImportError::Sound(error.to_string()))?;
    Ok(bytes.into_inner())
}

impl Table {
    /// The samples a second of a sound, and those of its first channel. `None` for any other table.
    pub fn sound(&self) -> Option<(f64, &[f64])> {
        let [time, sound, ..] = self.columns.as_slice() else { return None };
        let rest = self.form.strip_prefix(FORM)?.strip_prefix(": ")?;
        let rate: f64 = rest.split_once(' ')?.0.parse().ok()?;
        (time.name == "t" && rate > 0.0).then_some((rate, sound.values.as_slice()))
    }
}
