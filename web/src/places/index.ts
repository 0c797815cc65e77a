// What does not move by itself: stations, racks, places; and areas that are closed to robots.
export {};
