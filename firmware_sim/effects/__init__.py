"""What a real gyro, its surroundings, its encoder and its link add to an ideal measurement; rooms by stage."""
