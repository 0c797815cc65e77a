// Why a robot or a job waits, or waited: the chain from the one that waits down to the root.
export { whyOf, type WhyShown } from './shown';
