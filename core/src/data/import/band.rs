//! Checks of a band.

use super::ImportError;

/// A sentence about a band with an upper limit that has no effect.
pub(super) fn above_nyquist(band: Option<[f64; 2]>, nyquist: f64) -> Result<Option<String>, ImportError> {
    let Some([low, high]) = band.filter(|[_, high]| *high >= nyquist) else { return Ok(None) };
    if low >= nyquist {
        let (key, value) = ("band".to_owned(), format!("[{low}, {high}]"));
        let allowed = format!("below the Nyquist frequency, {nyquist} Hz");
        return Err(ImportError::Setting { key, value, allowed });
    }
    Ok(Some(format!(
        "the band's upper limit, {high} Hz, is not below the Nyquist frequency, {nyquist} Hz: it takes nothing away"
    )))
}

#[cfg(test)]
mod tests {
    use super::super::builder::tests::{TEXT, import};

    #[test]
    fn bands_above_the_nyquist_frequency_are_told() {
        let band = |low, high| import(TEXT, |mapping| mapping.band = Some([low, high]));
        let remarks = band(1.0, 90.0).unwrap().remarks;
        assert!(remarks[0].contains("90 Hz, is not below the Nyquist frequency, 5 Hz"), "{remarks:?}");
        assert!(band(6.0, 90.0).unwrap_err().to_string().contains("below the Nyquist frequency, 5 Hz"));
    }
}
