//! Finds the offset between the clocks of two files, from their readings of one oscillator.
//!
//! ```text
//! input ──H(ω; ωₙ, ζ)──▶ prediction ┐
//! sensor ──(iω)ⁿ───────▶ prediction ┴─ correlation with the other file's sensor at each lag ──▶ the largest one
//! ```

use std::collections::VecDeque;
use std::fmt;

use super::correlation::{Clocked, Peak, Spectra, times};
use super::files::{Clock, Joined, apart, join_on_steps};
use super::{ImportError, Mapping, Table};
use crate::{Quantity, Task};

/// The offset between two clocks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClockOffset {
    /// The seconds to add to the times of the second file \[s\].
    pub seconds: f64,
    /// The correlation of both files then: 1 if one predicts the other without an error.
    pub correlation: f64,
    /// Whether they have opposite signs.
    pub is_turned: bool,
}

/// The pair of columns by which two files agree best, and its offset.
#[derive(Clone, Debug, PartialEq)]
pub struct Agreement {
    /// The offset between their clocks.
    pub offset: ClockOffset,
    /// The column of each file.
    pub columns: [String; 2],
}

impl fmt::Display for Agreement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { offset: ClockOffset { seconds, correlation, is_turned }, columns: [first, second] } = self;
        write!(
            f,
            "{seconds:.4} s are added to the times of the second file: then `{first}` and `{second}` agree best, with a correlation of {correlation:.2}"
        )?;
        if *is_turned { f.write_str(", with opposite signs: one of them is turned") } else { Ok(()) }
    }
}

/// Less than this correlation is no agreement.
const LEAST: f64 = 0.35;

/// The correlation at other lags, further away than a swing, that makes an answer doubtful, as a share of the largest one.
const DOUBTFUL: f64 = 0.97;

/// Limits the samples of each file that are looked at.
const MOST: usize = 1 << 16;

/// The natural frequencies, in those of the strongest swing, and the damping ratios with which a search begins.
const FREQUENCIES: [f64; 7] = [0.85, 0.9, 0.95, 1.0, 1.05, 1.1, 1.15];
const DAMPINGS: [f64; 4] = [0.005, 0.02, 0.06, 0.15];

/// The search ends at steps of this share of a parameter.
const FINE: f64 = 2e-5;

/// The looks at a pair of columns that a search takes, about.
const LOOKS: f64 = 110.0;

impl ClockOffset {
    /// The offset with which the sensor of one file is best predicted from the sensor or the input of the other.
    ///
    /// # Errors
    /// [`ImportError`] where a file has no usable times or lacks the column, or where nothing is predicted.
    pub fn between(first: Clocked<'_>, second: Clocked<'_>) -> Result<Self, ImportError> {
        let mut pair = Pair::new(first, second)?;
        while !pair.step() {}
        pair.offset()
    }
}

/// The search for the agreement of two files, a look at a time.
pub struct OffsetSearch {
    pairs: VecDeque<Pair>,
    all: usize,
    best: Option<Agreement>,
    reason: ImportError,
}

impl OffsetSearch {
    /// The search between two files. `meaning` tells what the columns of both mean, each by its name in a table that has all.
    ///
    /// # Errors
    /// [`ImportError`] where a file has no usable times.
    pub fn new(tables: [&Table; 2], meaning: impl FnOnce(&Table) -> Mapping) -> Result<Self, ImportError> {
        // What the columns mean does not depend on their times: begin both at the same one.
        let names = ["the first file", "the second file"];
        let Joined { table, sources, .. } = join_on_steps(tables, apart(tables)?, names)?;
        let mapping = meaning(&table);
        let source = |column: &str| sources.get(table.place(column)?.checked_sub(1)?);
        let told: Vec<(&(bool, String), Option<Quantity>)> = (mapping.input.iter().map(|input| (&input.column, None)))
            .chain(mapping.sensors.iter().map(|(quantity, sensor)| (&sensor.column, Some(*quantity))))
            .filter_map(|(column, measures)| Some((source(column)?, measures)))
            .collect();
        let of = |is_second: bool| {
            let table = tables[usize::from(is_second)];
            let own = told.iter().filter(move |((second, _), _)| *second == is_second);
            own.map(move |((_, column), measures)| Clocked { table, column, measures: *measures })
        };
        let pairs = of(false).flat_map(|first| of(true).map(move |second| Pair::new(first, second)));
        let pairs = pairs.collect::<Result<VecDeque<Pair>, ImportError>>()?;
        Ok(Self { all: pairs.len(), pairs, best: None, reason: ImportError::NoCommonSignal })
    }
}

impl Task for OffsetSearch {
    /// [`ImportError`] where no two columns tell an offset.
    type Outcome = Result<Agreement, ImportError>;

    fn progress(&self) -> f64 {
        let of_pair = self.pairs.front().map_or(0.0, |pair| (pair.looks as f64 / LOOKS).min(0.95));
        ((self.all - self.pairs.len()) as f64 + of_pair) / self.all.max(1) as f64
    }

    fn advance(&mut self, while_time: &mut dyn FnMut() -> bool) -> bool {
        while let Some(pair) = self.pairs.front_mut() {
            if pair.step() {
                match pair.offset() {
                    Ok(offset)
                        if self.best.as_ref().is_none_or(|best| offset.correlation > best.offset.correlation) =>
                    {
                        self.best = Some(Agreement { offset, columns: pair.columns.clone() });
                    }
                    Ok(_) => {}
                    Err(error) => self.reason = error,
                }
                self.pairs.pop_front();
            }
            if !while_time() {
                break;
            }
        }
        self.pairs.is_empty()
    }

    fn finish(mut self) -> Self::Outcome {
        while !self.advance(&mut || true) {}
        self.best.ok_or(self.reason)
    }
}

/// The order of the derivative of the displacement that a sensor measures; `None` for an angle and the like.
fn order(measures: Quantity) -> Option<i32> {
    [Quantity::DISPLACEMENT, Quantity::VELOCITY, Quantity::ACCELERATION]
        .iter()
        .position(|quantity| *quantity == measures)
        .map(|place| place as i32)
}

/// The way to predict the other column.
#[derive(Clone, Copy)]
enum Prediction {
    /// A derivative of a sensor of the first file.
    Derivative(i32),
    /// The response to the input of the file at a place, of which the sensor measures a derivative of this order.
    Response(usize, i32),
    Nothing,
}

/// A column of each file, and the search for the lag between them.
struct Pair {
    columns: [String; 2],
    /// The first times of both files \[s\].
    starts: [f64; 2],
    dt: f64,
    spectra: Spectra,
    prediction: Prediction,
    /// Natural frequencies \[rad/s\] and damping ratios to begin with.
    begins: Vec<[f64; 2]>,
    best: Option<(Peak, [f64; 2])>,
    /// The steps of both, as shares of them, the direction of the next one, and whether one of this round was better.
    steps: [f64; 2],
    direction: usize,
    is_better: bool,
    looks: usize,
}

impl Pair {
    fn new(first: Clocked<'_>, second: Clocked<'_>) -> Result<Self, ImportError> {
        let clocks = [Clock::of(first.table, &mut Vec::new())?, Clock::of(second.table, &mut Vec::new())?];
        let dt = clocks.iter().map(|clock| clock.timing.dt).fold(f64::INFINITY, f64::min);
        let longest = clocks.iter().map(|clock| clock.ends()[1] - clock.ends()[0]).fold(0.0, f64::max);
        let dt = dt.max(longest / MOST as f64);
        let spectra = Spectra::new([(&clocks[0], first), (&clocks[1], second)], dt)?;
        let order = |of: Clocked<'_>| of.measures.and_then(order);
        let prediction = match (order(first), order(second)) {
            (Some(a), Some(b)) => Prediction::Derivative(b - a),
            (None, Some(order)) if first.measures.is_none() => Prediction::Response(0, order),
            (Some(order), None) if second.measures.is_none() => Prediction::Response(1, order),
            _ => Prediction::Nothing,
        };
        let pairs = FREQUENCIES.iter().flat_map(|share| DAMPINGS.map(|damping| [share * spectra.swing, damping]));
        Ok(Self {
            columns: [first, second].map(|clocked| clocked.column.to_owned()),
            starts: [clocks[0].ends()[0], clocks[1].ends()[0]],
            dt,
            begins: pairs.collect(),
            spectra,
            prediction,
            best: None,
            steps: [0.03, 0.5],
            direction: 0,
            is_better: false,
            looks: 0,
        })
    }

    /// Goes on by a look. Returns whether the largest correlation is found.
    fn step(&mut self) -> bool {
        self.looks += 1;
        let (input, order) = match self.prediction {
            Prediction::Nothing => return true,
            Prediction::Derivative(order) => {
                let peak = self.spectra.best(0, &|w| Spectra::differentiated(order, w), true);
                self.best = peak.map(|peak| (peak, [0.0; 2]));
                return true;
            }
            Prediction::Response(input, order) => (input, order),
        };
        if let Some(at) = self.begins.pop() {
            self.look(input, order, at);
            return false;
        }
        let Some((_, mut next)) = self.best else { return true };
        if self.steps[0] <= FINE {
            return true;
        }
        let (axis, sign) = (self.direction / 2, if self.direction.is_multiple_of(2) { 1.0 } else { -1.0 });
        next[axis] *= libm::exp(sign * self.steps[axis]);
        self.is_better |= self.look(input, order, next);
        self.direction = (self.direction + 1) % 4;
        if self.direction == 0 && !std::mem::take(&mut self.is_better) {
            self.steps = self.steps.map(|step| 0.5 * step);
        }
        false
    }

    /// Looks at the response of an oscillator. Returns whether it is the best so far.
    fn look(&mut self, input: usize, order: i32, at: [f64; 2]) -> bool {
        let [frequency, damping] = at;
        let response = |w: f64| {
            // 1 / (ωₙ² - ω² + 2iζωₙω)
            let (re, im) = (frequency * frequency - w * w, 2.0 * damping * frequency * w);
            let square = re * re + im * im;
            times(Spectra::differentiated(order, w), (re / square, -im / square))
        };
        let size = |peak: &Peak| peak.correlation.abs();
        let peak = self.spectra.best(input, &response, false).filter(|peak| peak.correlation.is_finite());
        let better = peak.filter(|peak| self.best.as_ref().is_none_or(|(best, _)| size(peak) > size(best)));
        self.best = better.map(|peak| (peak, at)).or(self.best);
        better.is_some()
    }

    /// The offset by the largest correlation.
    fn offset(&self) -> Result<ClockOffset, ImportError> {
        let [first, second] = self.columns.clone();
        let found = self
            .best
            .filter(|(peak, _)| peak.correlation.abs() >= LEAST && peak.others <= DOUBTFUL * peak.correlation.abs());
        let (Peak { lag, correlation, .. }, _) = found.ok_or(ImportError::NoOffset { first, second })?;
        let is_from_second = matches!(self.prediction, Prediction::Response(1, _));
        let later = lag * self.dt * if is_from_second { -1.0 } else { 1.0 };
        Ok(ClockOffset {
            seconds: self.starts[0] - self.starts[1] - later,
            correlation: correlation.abs(),
            is_turned: correlation < 0.0,
        })
    }
}
