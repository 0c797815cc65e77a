// Tests read English, whatever the machine speaks.
import { learn } from '../src/headset/words';

await learn('en');
