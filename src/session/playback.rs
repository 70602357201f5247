//! The position of playback, and its motion.

use super::Session;

impl Session {
    pub fn playing(&self) -> bool {
        self.playing
    }

    pub fn speed(&self) -> f64 {
        self.speed
    }

    pub fn next_speed(&self, faster: bool) -> f64 {
        let mut speeds = Self::SPEEDS.into_iter();
        let next = if faster { speeds.find(|s| *s > self.speed) } else { speeds.rfind(|s| *s < self.speed) };
        next.unwrap_or(self.speed)
    }

    pub fn end(&self) -> f64 {
        let (dt, samples) = self.target();
        samples.saturating_sub(1) as f64 * dt
    }

    pub fn position(&self) -> usize {
        // A clock that was set to k dt must give k in spite of rounding.
        let (dt, samples) = self.target();
        ((self.clock / dt + 1e-6) as usize).min(samples.saturating_sub(1))
    }

    pub fn time(&self) -> f64 {
        self.run().record().time_of(0) + self.position() as f64 * self.target().0
    }

    pub fn index(&self) -> usize {
        // While another picture is computed, time may be divided in another way there.
        let position = match self.job {
            Some(_) => (self.clock / self.run().record().dt() + 1e-6) as usize,
            None => self.position(),
        };
        let index = position.saturating_sub(self.run().record().forgotten());
        index.min(self.run().len().saturating_sub(1))
    }

    pub fn sample_at(&self, time: f64) -> usize {
        let record = self.run().record();
        let last = self.run().len().saturating_sub(1);
        (((time - record.time(0)) / record.dt()).round().max(0.0) as usize).min(last)
    }

    pub fn advance(&mut self, elapsed: f64) {
        let mut while_time = self.budget.slice();
        // A live sensor gives the time, and the measurement asks for frames.
        if self.behind() || self.is_live() {
            self.compute();
        } else if self.playing {
            self.clock += elapsed * self.speed;
            if self.clock >= self.end() {
                self.clock = self.end();
                self.playing = false;
            }
            self.compute();
        }
        self.diagnose_in_time(elapsed);
        self.diagnose(elapsed);
        self.follow_before(&mut while_time);
        self.try_causes(&mut while_time);
        self.run_freely();
        self.follow_spectrogram();
    }

    pub fn toggle_play(&mut self) {
        if !self.playing && self.clock >= self.end() && !self.is_live() {
            self.play_from_start();
        } else {
            self.playing = !self.playing;
        }
    }

    pub fn pause(&mut self) {
        self.playing = false;
    }

    pub fn play_from_start(&mut self) {
        self.seek(0.0);
        self.playing = true;
    }

    pub fn step(&mut self) {
        self.playing = false;
        self.seek((self.position() + 1) as f64 * self.target().0);
    }

    pub fn step_back(&mut self) {
        self.playing = false;
        self.seek(self.position().saturating_sub(1) as f64 * self.target().0);
    }

    pub fn seek(&mut self, time: f64) {
        self.clock = time.clamp(0.0, self.end());
        self.playing &= !self.is_live();
        self.go_back();
        self.compute();
    }

    pub fn seek_end(&mut self) {
        if self.can_be_whole {
            self.playing = false;
            // The length is known only once the job has its record; the end of the job limits the clock.
            self.clock = f64::INFINITY;
            self.compute();
        }
    }

    pub fn set_speed(&mut self, speed: f64) {
        if speed.is_finite() && speed > 0.0 {
            self.speed = speed;
        }
    }
}
