// The page of the API's descriptions: /openapi.json and /asyncapi.json, to be read and searched.
// It loads nothing of the dashboard but its colours, and nothing from anywhere else.
export { page } from './page';
