// Timelines: what holds the places of an area when, as the planner sees it now, or as it was.
export {};
