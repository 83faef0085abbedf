"""What tools/bench_report.py and tools/stress.py are made of."""
