/* The learning loop in plain C, the yardstick for rssnav/kernels/tabular.py.
 *
 * The same work a step (decay, epsilon-greedy choice over the possible actions, move, reward,
 * update, visit count, path hash) on the same tables with the same generator, xoshiro256++. Twice:
 * learn_plain scans the rows of Q it needs when it needs them, as one writes it first;
 * learn_cached keeps each row's maximum beside the table, as the Python kernel does.
 * Both give the results of the Python kernel bit for bit when built with -ffp-contract=off.
 *
 * tests/benchmarks/test_bench_learning.py builds it and times both against the kernel:
 *     pytest tests/benchmarks/test_bench_learning.py --benchmark-enable -s
 */
#include <stdbool.h>
#include <stdint.h>

typedef struct {
    const int32_t *next_state;  /* S x 8, -1 where blocked */
    const uint8_t *possible;    /* S x 8, possible actions first */
    const uint8_t *n_possible;  /* S */
    const bool *terminal;       /* S */
    const double *reward;       /* S x 8 */
    int64_t start;
} moves_t;

typedef struct {
    double gamma, epsilon_min, alpha_min, decay;
    int64_t max_steps;
} parameters_t;

typedef struct {
    double *q;           /* S x 8, -inf where blocked */
    double *best_value;  /* S, for learn_cached */
    uint8_t *best_action; /* S, for learn_cached */
    int32_t *visits;     /* S */
    uint64_t *generator; /* 4 */
    double epsilon, alpha;
    int32_t *steps;      /* episodes */
    uint64_t *path_hash; /* episodes */
} run_t;

static inline uint64_t rotl(uint64_t x, int k) { return (x << k) | (x >> (64 - k)); }

static inline uint64_t next_bits(uint64_t s[4])
{
    const uint64_t bits = rotl(s[0] + s[3], 23) + s[0], t = s[1] << 17;
    s[2] ^= s[0];
    s[3] ^= s[1];
    s[1] ^= s[2];
    s[0] ^= s[3];
    s[2] ^= t;
    s[3] = rotl(s[3], 45);
    return bits;
}

static inline int first_best(const double *row)
{
    int best = 0;
    for (int a = 1; a < 8; a++)
        if (row[a] > row[best])
            best = a;
    return best;
}

static inline void learn(const moves_t *m, const parameters_t *p, run_t *run, int64_t episodes,
                         const bool cached)
{
    uint64_t s[4] = {run->generator[0], run->generator[1], run->generator[2], run->generator[3]};
    double epsilon = run->epsilon, alpha = run->alpha;
    double *const q = run->q;
    for (int64_t episode = 0; episode < episodes; episode++) {
        int64_t state = m->start;
        int32_t steps = 0;
        uint64_t hash = 0xCBF29CE484222325u;
        bool done = false;
        run->visits[state]++;
        while (!done && steps < p->max_steps) {
            if (epsilon >= p->epsilon_min)
                epsilon *= p->decay;
            if (alpha >= p->alpha_min)
                alpha *= p->decay;
            double *const row = q + 8 * state;
            const uint64_t bits = next_bits(s);
            int action;
            if ((double)(bits >> 32) * 0x1p-32 < epsilon)
                action = m->possible[8 * state + (((uint32_t)bits * (uint64_t)m->n_possible[state]) >> 32)];
            else
                action = cached ? run->best_action[state] : first_best(row);
            const int64_t arrived = m->next_state[8 * state + action];
            done = m->terminal[arrived];
            const double *const there = q + 8 * arrived;
            const double value = cached ? run->best_value[arrived] : there[first_best(there)];
            const double target = m->reward[8 * state + action] + p->gamma * value;
            row[action] = (1.0 - alpha) * row[action] + alpha * target;
            if (cached) {
                const double best = run->best_value[state];
                const int first = run->best_action[state];
                if (action == first && row[action] < best)
                    run->best_action[state] = (uint8_t)first_best(row);
                else if (row[action] > best || (row[action] == best && action < first))
                    run->best_action[state] = (uint8_t)action;
                run->best_value[state] = row[run->best_action[state]];
            }
            hash = (hash ^ (uint64_t)(action + 1)) * 0x9E3779B97F4A7C15u;
            steps++;
            run->visits[arrived]++;
            state = arrived;
        }
        run->steps[episode] = steps;
        run->path_hash[episode] = hash;
    }
    run->epsilon = epsilon;
    run->alpha = alpha;
    for (int k = 0; k < 4; k++)
        run->generator[k] = s[k];
}

void learn_plain(const moves_t *m, const parameters_t *p, run_t *run, int64_t episodes)
{
    learn(m, p, run, episodes, false);
}

void learn_cached(const moves_t *m, const parameters_t *p, run_t *run, int64_t episodes)
{
    learn(m, p, run, episodes, true);
}
