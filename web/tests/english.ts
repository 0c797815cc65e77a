// Tests read English, whatever the machine speaks.
import { learn as learnHeadset } from '../src/headset/words';
import { learn as learnStation } from '../src/station/words';
import { learn, learnMore } from '../src/words';

await Promise.all([learn('en'), learnHeadset('en'), learnStation('en')]);
await learnMore();
