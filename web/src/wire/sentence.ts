// What the server says to people, and why it refused a request.

/** What the server says to people: which sentence, what stands in its places, and the same in English. Recordings of
 *  earlier versions have the text alone. */
export interface Sentence {
  code?: string | null;
  args?: Record<string, SentenceArg>;
  text: string;
}
export type SentenceArg = string | number | Sentence | readonly SentenceArg[];
/** One wrong field; the detail is a sentence. */
export interface FieldError {
  field: string;
  detail: string;
  code?: string;
  args?: Record<string, SentenceArg>;
}
/** RFC 9457, with the field each error belongs to. */
export interface Problem {
  type?: string;
  title: string;
  status: number;
  detail?: string;
  /** Which sentence the detail is. */
  code?: string;
  args?: Record<string, SentenceArg>;
  errors?: FieldError[];
}
