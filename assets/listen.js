// Hands the microphone's samples over to the page, some at a time.
"use strict";

// The samples of one message: 21 ms at 48 kHz.
const LENGTH = 1024;

registerProcessor("listen", class extends AudioWorkletProcessor {
  constructor() {
    super();
    this.samples = new Float32Array(LENGTH);
    this.count = 0;
  }

  process([[channel]]) {
    for (const sample of channel ?? []) {
      this.samples[this.count++] = sample;
      if (this.count === LENGTH) {
        this.port.postMessage(this.samples);
        this.count = 0;
      }
    }
    return true;
  }
});
