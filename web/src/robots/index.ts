// The card of a robot, with what a person may tell it; and the stop of all robots.
export {};
