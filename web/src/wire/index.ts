// The wire: what travels between a page and the server, the requests, the live link and the copy of the floor it keeps.
// It knows no other room, and no word that a person reads but why a request failed.
export * from './map';
export * from './sentence';
export * from './robots';
export type {
  ActionFate,
  KindFigure,
  LinkedApi,
  LinkedRobot,
  NewAction,
  NewLinked,
  NoticedOfRobot,
  NotJoined,
  SaidError,
  SaidMessage,
  SaidState,
  UnlistedRobot,
} from './linked';
export * from './workers';
export * from './closures';
export * from './alarms';
export * from './audit';
export * from './feed';
export * from './jobs';
export * from './why';
export * from './station';
export * from './history';
export { ACTS, type Act } from './acts';
export * from './past';
export * from './report';
export { Api, PAST, type Answer } from './api';
export { Keys, newKey } from './keys';
export { Link, retryDelay, type Clock, type LinkState, type Socket, type SocketEvents } from './link';
export { floorDate, floorNow, hearTime } from './now';
export { activityOf, ageOf, EMPTY, onFloor, reduce, row, type Mirror, type Table } from './mirror';
