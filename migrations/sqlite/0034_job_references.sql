-- Looking for jobs by a part of what customers call them: an index of all runs of three characters, so that a part of three
-- or more is found without reading the jobs. It holds the runs alone, not the text. A reference never changes, so a row comes
-- and goes with its job.
CREATE VIRTUAL TABLE job_references USING fts5(text, content='', contentless_delete=1, tokenize='trigram');
INSERT INTO job_references (rowid, text) SELECT id, reference FROM jobs WHERE reference IS NOT NULL;
CREATE TRIGGER job_references_begin AFTER INSERT ON jobs WHEN new.reference IS NOT NULL BEGIN
    INSERT INTO job_references (rowid, text) VALUES (new.id, new.reference);
END;
CREATE TRIGGER job_references_end AFTER DELETE ON jobs WHEN old.reference IS NOT NULL BEGIN
    DELETE FROM job_references WHERE rowid = old.id;
END;
