// The report of a stretch of time: what was delivered, what robots and stations were at, what they waited for, people.
// It counts nothing itself: the server does.
export { lateJobs } from './late';
export { SPANS, spanOf, typed, type SpanName } from './spans';
