"""What several tests share: arms, moves, messages, independent computations. No test imports another test."""
