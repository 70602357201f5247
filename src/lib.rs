//! Kalmanscope: the explorer's app.
