// Robots: how many are at what, their table, the card of one with what a person may tell it; and the stop of all
// robots.
export { countsOf, type ActivityCount } from './counts';
