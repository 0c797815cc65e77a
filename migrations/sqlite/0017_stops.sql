-- Deliveries to several stations, and operators who choose robots. Both columns are JSON, and null for most jobs.
-- `stops`: `served`, stations whose pick has ended as [[station, pick], when], and `then`, those to come as
-- [station, pick]; `station` and `pick` are of the one between them. `choice`: which robots may do the job.
ALTER TABLE jobs ADD COLUMN stops TEXT;
ALTER TABLE jobs ADD COLUMN choice TEXT;
