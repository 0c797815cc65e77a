// Figures over time as charts, live or of what a replay has in sight; and the comparison of an experiment's arms.
export {};
