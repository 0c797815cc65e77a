-- Sessions of people who signed in with an identity provider: `name` and `role` are theirs, and `token` is empty, so
-- that the release before takes such a session for none. Both are null where the session stands for a token.
ALTER TABLE sessions ADD COLUMN name TEXT;
ALTER TABLE sessions ADD COLUMN role TEXT;
