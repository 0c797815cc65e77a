// How well somebody is seen, in words: what the server counted of the poses, and how the rest of it stands. Pure.
import { listed, number, percent, quantity, t } from '../words';
import type { WorkerDetail } from '../wire';

/** Two looks at the same worker, and the time between them. */
export interface Looks {
  before: WorkerDetail | null;
  now: WorkerDetail;
  apart_s: number;
}
export interface Word {
  name: string;
  text: string;
  /** Whether it is as it should be. */
  well: boolean;
}

/** A feed slower than this is too slow to follow somebody who walks, poses a second. */
const SLOW_HZ = 4;
const OLD_S = 0.5;
const UNSURE_M = 0.3;

export function feedWords({ before, now, apart_s }: Looks, lost: number | null): Word[] {
  const words: Word[] = [];
  if (before && apart_s > 0.2) {
    const hz = Math.max(0, now.feed.taken - before.feed.taken) / apart_s;
    words.push({
      name: t('feed.rate'),
      text: t('feed.rate.value', { rate: number(hz, hz < 10 ? 1 : 0) }),
      well: hz >= SLOW_HZ,
    });
  }
  if (now.age_s !== null) {
    const time = quantity(now.age_s, 's', now.age_s < 10 ? 2 : 0);
    words.push({ name: t('feed.latest'), text: t('feed.latest.value', { time }), well: now.age_s <= OLD_S });
  }
  words.push({ name: t('feed.accuracy'), text: `± ${quantity(now.accuracy, 'm', 2)}`, well: now.accuracy <= UNSURE_M });
  if (now.clock_error_ms !== null) {
    const time = quantity(now.clock_error_ms, 'ms', now.clock_error_ms < 10 ? 1 : 0);
    words.push({ name: t('feed.clock'), text: t('feed.clock.value', { time }), well: now.clock_error_ms < 100 });
  } else {
    words.push({
      name: t('feed.clock'),
      text: t(now.connected ? 'feed.clock.unknown' : 'feed.clock.server'),
      well: true,
    });
  }
  const { taken, late, jumps, absurd } = now.feed;
  const refused = late + jumps + absurd;
  const parts = [
    late > 0 ? t('feed.refused.late', { count: late }) : '',
    jumps > 0 ? t('feed.refused.jumps', { count: jumps }) : '',
    absurd > 0 ? t('feed.refused.absurd', { count: absurd }) : '',
  ].filter(Boolean);
  const share = refused / Math.max(1, taken + refused);
  words.push({
    name: t('feed.refused'),
    well: share < 0.1,
    text:
      refused === 0
        ? t('feed.refused.none', { all: taken })
        : t('feed.refused.value', {
            share: share < 0.01 ? t('under', { most: percent(0.01) }) : percent(share),
            all: taken + refused,
            parts: listed(parts),
          }),
  });
  if (lost !== null)
    words.push({ name: t('feed.unseen'), text: t('feed.unseen.value', { share: percent(lost) }), well: lost < 0.05 });
  return words;
}
