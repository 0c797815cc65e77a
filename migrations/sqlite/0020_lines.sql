-- What is picked from a rack at each of a job's stations, and how far that is: a list of visits, each a list of lines as
-- [what was ordered, state, pieces in the tote]. Null for jobs without lines.
ALTER TABLE jobs ADD COLUMN lines TEXT;
